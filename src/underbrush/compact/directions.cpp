#include "underbrush/compact/directions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "underbrush/compact/exact_math.hpp"

namespace underbrush::compact {
namespace {

constexpr size_t kRowsOfGroup = 32;  // on average at least; else the groups would cost too much

enum Pattern : uint8_t { kNoPattern, kByTime, kByNumber };

/// The beams of one ring and scan: places [begin, end) of the order by ring.
struct Group {
  uint32_t begin = 0, end = 0;
  double azimuth_rad = 0;  ///< Of its first beam, in the sensor's frame.
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

/// A predicted direction and how it changes with the elevation (world frame).
struct Guess {
  Vector at, up;
};

Guess guess_of(const Fired& f, const Group& g, Pattern pattern, size_t place, size_t row) {
  const SineCosine a = sine_cosine(g.azimuth_rad + g.rate * progress(f, g, pattern, place));
  const double s = g.elevation_sine, c = g.elevation_cosine;
  const Guess guess = {{c * a.cosine, c * a.sine, s}, {-s * a.cosine, -s * a.sine, c}};
  if (f.place.empty()) return guess;
  const Turn& turn = f.place[row].turn;
  return {rotated(turn, guess.at), rotated(turn, guess.up)};
}

// Turns the guess by the small elevation that gives it the known z.
Vector turned(const Guess& g, double z) {
  const double square = g.at.z * g.at.z + g.up.z * g.up.z, rest = square - z * z;
  if (!(rest > 0)) return g.at;
  const double q = g.up.z < 0 ? -std::sqrt(rest) : std::sqrt(rest);
  const double sine = (z * g.up.z - g.at.z * q) / square;
  const double cosine = (z * g.at.z + g.up.z * q) / square;
  return {g.at.x * cosine + g.up.x * sine, g.at.y * cosine + g.up.y * sine, z};
}

uint32_t number_of(double x) {
  return ordered(x >= -2 && x <= 2 ? float(x) : 0.0f);  // not a number has no bits to rely on
}

/// What is left of a direction's components: of z, and of the smaller and larger one of x and y.
using Rest = std::array<std::vector<uint32_t>, 3>;

bool is_x_smaller(const Vector& v) { return std::abs(v.x) <= std::abs(v.y); }

// The larger one of x and y by the unit length, with the sign of the guess.
double by_length(double z, double smaller, double guess) {
  const double square = 1 - z * z - smaller * smaller;
  if (!(square > 0)) return guess;
  return guess < 0 ? -std::sqrt(square) : std::sqrt(square);
}

template <class F>
void for_each_guess(const Fired& f, const std::vector<Group>& groups, Pattern pattern, F use) {
  for (const Group& g : groups) {
    for (size_t k = g.begin; k < g.end; ++k) {
      const size_t row = row_of(f, k);
      use(row, guess_of(f, g, pattern, k, row));
    }
  }
}

double bits_of(uint32_t rest) {
  return double(std::bit_width((rest << 1) ^ uint32_t(int32_t(rest) >> 31)));
}

}  // namespace

void pack_directions(std::span<const Vec3f> direction, const Fired& f, Codec& codec,
                     std::string& out) {
  const size_t n = direction.size();
  Rest rest;
  for (auto& column : rest) column.resize(n);
  std::vector<Group> groups = groups_of(f);
  if (groups.size() * kRowsOfGroup > n) {
    put(out, kNoPattern);
    for (size_t i = 0; i < n; ++i) {
      for (size_t c = 0; c < 3; ++c) rest[c][i] = ordered(direction[i][Eigen::Index(c)]);
    }
  } else {
    std::vector<Group> numbered = groups;
    Pattern pattern = kByTime;
    if (fit(direction, f, kByNumber, numbered) < fit(direction, f, kByTime, groups)) {
      pattern = kByNumber;
      groups = std::move(numbered);
    }
    std::vector<uint32_t> lengths(n);
    double guessed = 0, measured = 0;
    for_each_guess(f, groups, pattern, [&](size_t row, const Guess& guess) {
      const Vec3f& d = direction[row];
      rest[0][row] = ordered(d.z()) - number_of(guess.at.z);
      const Vector v = turned(guess, d.z());
      const bool x = is_x_smaller(v);
      const float smaller = x ? d.x() : d.y(), larger = x ? d.y() : d.x();
      const double larger_guess = x ? v.y : v.x;
      rest[1][row] = ordered(smaller) - number_of(x ? v.x : v.y);
      rest[2][row] = ordered(larger) - number_of(larger_guess);
      lengths[row] = ordered(larger) - number_of(by_length(d.z(), smaller, larger_guess));
      guessed += bits_of(rest[2][row]);
      measured += bits_of(lengths[row]);
    });
    put(out, pattern);
    put(out, uint8_t(measured < guessed));
    if (measured < guessed) rest[2] = std::move(lengths);
    for (const Group& g : groups) {
      for (const double v : {g.azimuth_rad, g.rate, g.elevation_sine, g.elevation_cosine}) {
        put(out, v);
      }
    }
  }
  for (const auto& column : rest) codec.pack<uint32_t>(column, f.by_ring, out);
}

void unpack_directions(Cursor& in, const Fired& f, Codec& codec, std::span<Vec3f> direction) {
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
  Rest rest;
  for (auto& column : rest) {
    column.resize(direction.size());
    codec.unpack<uint32_t>(in, f.by_ring, column);
  }
  if (pattern == kNoPattern) {
    for (size_t i = 0; i < direction.size(); ++i) {
      direction[i] = {from_ordered(rest[0][i]), from_ordered(rest[1][i]), from_ordered(rest[2][i])};
    }
    return;
  }
  for_each_guess(f, groups, pattern, [&](size_t row, const Guess& guess) {
    const float z = from_ordered(rest[0][row] + number_of(guess.at.z));
    const Vector v = turned(guess, z);
    const bool x = is_x_smaller(v);
    const float smaller = from_ordered(rest[1][row] + number_of(x ? v.x : v.y));
    double larger_guess = x ? v.y : v.x;
    if (by_unit_length) larger_guess = by_length(z, smaller, larger_guess);
    const float larger = from_ordered(rest[2][row] + number_of(larger_guess));
    direction[row] = x ? Vec3f(smaller, larger, z) : Vec3f(larger, smaller, z);
  });
}

}  // namespace underbrush::compact
