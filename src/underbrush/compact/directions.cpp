#include "underbrush/compact/directions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "underbrush/compact/exact_math.hpp"
#include "underbrush/core/clones.hpp"

namespace underbrush::compact {
namespace {

constexpr size_t kRowsOfGroup = 32;  // on average at least; else the groups would cost too much

enum Pattern : uint8_t { kNoPattern, kByTime, kByNumber };

/// The beams of one ring and scan: places [begin, end) of the order by ring.
struct Group {
  uint32_t begin = 0, end = 0;
  double azimuth_rad = 0;  ///< Azimuth of the first beam in the sensor's frame.
  double rate = 0;         ///< rad a second, or rad a beam.
  double elevation_sine = 0, elevation_cosine = 1;
};

size_t row_of(const Fired& f, size_t place) { return f.by_ring.empty() ? place : f.by_ring[place]; }

std::vector<Group> groups_of(const Fired& f) {
  std::vector<Group> out;
  size_t last = 0;
  for (size_t k = 0; k < f.ring.size(); ++k) {
    const size_t row = row_of(f, k);
    if (out.empty() || f.ring[row] != f.ring[last] || f.scan[row] != f.scan[last]) {
      out.push_back({uint32_t(k), uint32_t(k)});
    }
    ++out.back().end;
    last = row;
  }
  return out;
}

/// How far a beam is along its group: seconds or beams since the first.
double progress(const Fired& f, const Group& g, Pattern pattern, size_t place) {
  return pattern == kByTime ? f.time_s[row_of(f, place)] - f.time_s[row_of(f, g.begin)]
                            : double(place - g.begin);
}

/// A direction in the sensor's frame, as angles.
struct Angles {
  double azimuth_rad, elevation_rad;
};

Angles angles_of(const Vec3f& d, const Fired& f, size_t row) {
  Vector v = {d.x(), d.y(), d.z()};
  if (!f.place.empty()) v = rotated(reverse(f.place[row].turn), v);
  return {std::atan2(v.y, v.x), std::atan2(v.z, std::sqrt(v.x * v.x + v.y * v.y))};
}

/// Some beams of a group: their progress and azimuth, and the rate of the azimuth to the next beam.
struct Samples {
  std::vector<double> along, azimuth, rates;
  double mean_elevation = 0;
};

Samples samples_of(std::span<const Vec3f> direction, const Fired& f, const Group& g,
                   Pattern pattern) {
  constexpr size_t kMost = 64;
  Samples s;
  const size_t n = g.end - g.begin, taken = std::min(n, kMost);
  for (size_t i = 0; i < taken; ++i) {
    const size_t k = g.begin + n * i / taken;
    const Angles a = angles_of(direction[row_of(f, k)], f, row_of(f, k));
    s.along.push_back(progress(f, g, pattern, k));
    s.azimuth.push_back(a.azimuth_rad);
    s.mean_elevation += a.elevation_rad / double(taken);
    if (k + 1 == g.end) continue;
    const double step = progress(f, g, pattern, k + 1) - s.along.back();
    if (step == 0) continue;
    const Angles next = angles_of(direction[row_of(f, k + 1)], f, row_of(f, k + 1));
    s.rates.push_back(std::remainder(next.azimuth_rad - a.azimuth_rad, 2 * M_PI) / step);
  }
  return s;
}

// Fits a line to the azimuths by least squares. Returns the mean square of what is left.
double fit_line(Samples& s, Group& g) {
  double rate = 0;
  if (!s.rates.empty()) {
    const auto middle = s.rates.begin() + std::ptrdiff_t(s.rates.size() / 2);
    std::nth_element(s.rates.begin(), middle, s.rates.end());
    rate = *middle;
  }
  const size_t n = s.along.size();
  double mean_along = 0, mean = 0, product = 0, square = 0, left = 0;
  for (size_t i = 0; i < n; ++i) {
    double& azimuth = s.azimuth[i];
    if (i > 0) {
      const double guess = s.azimuth[i - 1] + rate * (s.along[i] - s.along[i - 1]);
      azimuth = guess + std::remainder(azimuth - guess, 2 * M_PI);
    }
    mean_along += s.along[i] / double(n);
    mean += azimuth / double(n);
  }
  for (size_t i = 0; i < n; ++i) {
    product += (s.along[i] - mean_along) * (s.azimuth[i] - mean);
    square += (s.along[i] - mean_along) * (s.along[i] - mean_along);
  }
  rate = square > 0 ? product / square : 0;
  const double start = mean - rate * mean_along;
  if (!std::isfinite(start + rate)) return INFINITY;
  g.azimuth_rad = start;
  g.rate = rate;
  for (size_t i = 0; i < n; ++i) {
    const double rest = s.azimuth[i] - start - rate * s.along[i];
    left += rest * rest / double(n);
  }
  return left;
}

// Fits the groups' lines and elevations. Returns the sum of the squares of what is left.
double fit(std::span<const Vec3f> direction, const Fired& f, Pattern pattern,
           std::vector<Group>& groups) {
  double squares = 0;
  for (Group& g : groups) {
    Samples samples = samples_of(direction, f, g, pattern);
    squares += double(g.end - g.begin) * fit_line(samples, g);
    if (!std::isfinite(samples.mean_elevation)) continue;
    g.elevation_sine = std::sin(samples.mean_elevation);
    g.elevation_cosine = std::cos(samples.mean_elevation);
  }
  return squares;
}

/// What is left of a direction's components: of z, and of the smaller and larger one of x and y.
using Rest = std::array<std::vector<uint32_t>, 3>;

constexpr size_t kBlock = 256;

/// Beams of a group that are predicted together, a column for each value.
struct Block {
  using Column = std::array<double, kBlock>;
  size_t first = 0, size = 0;          ///< Places in the order by ring.
  Column angle{}, w{}, i{}, j{}, k{};  ///< The azimuth, and the sensor's turn as a quaternion.
  Column x{}, y{}, z{}, up_x{}, up_y{}, up_z{};  ///< The guess and how it rises with the elevation.
  Column known_z{};  ///< The beam's own z; then x and y are turned to it.
};

UNDERBRUSH_CLONES void guess(Block& b, double sine, double cosine) {
  for (size_t n = 0; n < kBlock; ++n) {
    const SineCosine a = sine_cosine(b.angle[n]);
    const Turn turn = {b.w[n], b.i[n], b.j[n], b.k[n]};
    const Vector at = rotated(turn, {cosine * a.cosine, cosine * a.sine, sine});
    const Vector up = rotated(turn, {-sine * a.cosine, -sine * a.sine, cosine});
    b.x[n] = at.x;
    b.y[n] = at.y;
    b.z[n] = at.z;
    b.up_x[n] = up.x;
    b.up_y[n] = up.y;
    b.up_z[n] = up.z;
  }
}

// Turns x and y of the guess by the small elevation that gives it the known z.
UNDERBRUSH_CLONES void turn_to_known_z(Block& b) {
  for (size_t n = 0; n < kBlock; ++n) {
    const double z = b.known_z[n], at = b.z[n], up = b.up_z[n];
    const double square = at * at + up * up, rest = square - z * z;
    const double root = std::sqrt(rest > 0 ? rest : 0.0);
    const double q = up < 0 ? -root : root;
    const double sine = (z * up - at * q) / square, cosine = (z * at + up * q) / square;
    const bool possible = rest > 0;
    b.x[n] = possible ? b.x[n] * cosine + b.up_x[n] * sine : b.x[n];
    b.y[n] = possible ? b.y[n] * cosine + b.up_y[n] * sine : b.y[n];
  }
}

void predict(const Fired& f, const Group& g, Pattern pattern, size_t first, Block& b) {
  b.first = first;
  b.size = std::min(kBlock, g.end - first);
  for (size_t n = 0; n < b.size; ++n) {
    b.angle[n] = g.azimuth_rad + g.rate * progress(f, g, pattern, first + n);
    const Turn turn = f.place.empty() ? Turn() : f.place[row_of(f, first + n)].turn;
    b.w[n] = turn.w;
    b.i[n] = turn.x;
    b.j[n] = turn.y;
    b.k[n] = turn.z;
  }
  guess(b, g.elevation_sine, g.elevation_cosine);
}

uint32_t number_of(double x) {
  return ordered(x >= -2 && x <= 2 ? float(x) : 0.0f);  // not a number has no bits to rely on
}

// The larger one of x and y by the unit length, with the sign of the guess.
double by_length(double z, double smaller, double guess) {
  const double square = 1 - z * z - smaller * smaller;
  if (!(square > 0)) return guess;
  return guess < 0 ? -std::sqrt(square) : std::sqrt(square);
}

template <class F>
void for_each_block(const Fired& f, const std::vector<Group>& groups, Pattern pattern, F use) {
  Block b;
  for (const Group& g : groups) {
    for (size_t first = g.begin; first < g.end; first += kBlock) {
      predict(f, g, pattern, first, b);
      use(b);
    }
  }
}

double bits_of(uint32_t rest) {
  return double(std::bit_width((rest << 1) ^ uint32_t(int32_t(rest) >> 31)));
}

// Codes the groups' beams. `lengths` becomes the third column where the larger one of x and y is
// predicted by the unit length. Returns whether that takes fewer bits.
bool code(std::span<const Vec3f> direction, const Fired& f, const std::vector<Group>& groups,
          Pattern pattern, Rest& rest, std::vector<uint32_t>& lengths) {
  double guessed = 0, measured = 0;
  for_each_block(f, groups, pattern, [&](Block& b) {
    for (size_t n = 0; n < b.size; ++n) {
      const size_t row = row_of(f, b.first + n);
      b.known_z[n] = direction[row].z();
      rest[0][row] = ordered(direction[row].z()) - number_of(b.z[n]);
    }
    turn_to_known_z(b);
    for (size_t n = 0; n < b.size; ++n) {
      const size_t row = row_of(f, b.first + n);
      const Vec3f& d = direction[row];
      const bool x = std::abs(b.x[n]) <= std::abs(b.y[n]);
      const float smaller = x ? d.x() : d.y();
      const uint32_t larger = ordered(x ? d.y() : d.x());
      const double larger_guess = x ? b.y[n] : b.x[n];
      rest[1][row] = ordered(smaller) - number_of(x ? b.x[n] : b.y[n]);
      rest[2][row] = larger - number_of(larger_guess);
      lengths[row] = larger - number_of(by_length(d.z(), smaller, larger_guess));
      guessed += bits_of(rest[2][row]);
      measured += bits_of(lengths[row]);
    }
  });
  return measured < guessed;
}

}  // namespace

void pack_directions(std::span<const Vec3f> direction, const Fired& f, Scratch& scratch,
                     std::string& out) {
  const size_t n = direction.size();
  Rest& rest = scratch.rest;
  for (auto& column : rest) column.resize(n);
  std::vector<Group> groups = groups_of(f);
  if (groups.size() * kRowsOfGroup > n) {
    put(out, kNoPattern);
    for (size_t i = 0; i < n; ++i) {
      for (size_t c = 0; c < 3; ++c) rest[c][i] = ordered(direction[i][Eigen::Index(c)]);
    }
  } else {
    constexpr double kExact = 1e-9;  // rad²; better than any sensor's azimuths
    std::vector<Group> numbered = groups;
    Pattern pattern = kByTime;
    const double timed = fit(direction, f, kByTime, groups);
    if (timed > kExact * double(n) && fit(direction, f, kByNumber, numbered) < timed) {
      pattern = kByNumber;
      groups = std::move(numbered);
    }
    std::vector<uint32_t>& lengths = scratch.words;
    lengths.resize(n);
    const bool by_unit_length = code(direction, f, groups, pattern, rest, lengths);
    put(out, pattern);
    put(out, uint8_t(by_unit_length));
    if (by_unit_length) std::swap(rest[2], lengths);
    for (const Group& g : groups) {
      for (const double v : {g.azimuth_rad, g.rate, g.elevation_sine, g.elevation_cosine}) {
        put(out, v);
      }
    }
  }
  for (const auto& column : rest) scratch.codec.pack<uint32_t>(column, f.by_ring, out);
}

void unpack_directions(Cursor& in, const Fired& f, Scratch& scratch, std::span<Vec3f> direction) {
  const auto pattern = in.get<Pattern>();
  if (pattern > kByNumber) in.fail("it has an unknown pattern of directions");
  std::vector<Group> groups;
  bool by_unit_length = false;
  if (pattern != kNoPattern) {
    by_unit_length = in.get<uint8_t>() != 0;
    groups = groups_of(f);
    for (Group& g : groups) {
      for (double* v : {&g.azimuth_rad, &g.rate, &g.elevation_sine, &g.elevation_cosine}) {
        *v = in.get<double>();
      }
    }
  }
  Rest& rest = scratch.rest;
  for (auto& column : rest) {
    column.resize(direction.size());
    scratch.codec.unpack<uint32_t>(in, f.by_ring, column);
  }
  if (pattern == kNoPattern) {
    for (size_t i = 0; i < direction.size(); ++i) {
      direction[i] = {from_ordered(rest[0][i]), from_ordered(rest[1][i]), from_ordered(rest[2][i])};
    }
    return;
  }
  for_each_block(f, groups, pattern, [&](Block& b) {
    for (size_t n = 0; n < b.size; ++n) {
      b.known_z[n] = from_ordered(rest[0][row_of(f, b.first + n)] + number_of(b.z[n]));
    }
    turn_to_known_z(b);
    for (size_t n = 0; n < b.size; ++n) {
      const size_t row = row_of(f, b.first + n);
      const bool x = std::abs(b.x[n]) <= std::abs(b.y[n]);
      const float z = from_ordered(rest[0][row] + number_of(b.z[n]));
      const float smaller = from_ordered(rest[1][row] + number_of(x ? b.x[n] : b.y[n]));
      double guess = x ? b.y[n] : b.x[n];
      if (by_unit_length) guess = by_length(z, smaller, guess);
      const float larger = from_ordered(rest[2][row] + number_of(guess));
      direction[row] = x ? Vec3f(smaller, larger, z) : Vec3f(larger, smaller, z);
    }
  });
}

}  // namespace underbrush::compact
