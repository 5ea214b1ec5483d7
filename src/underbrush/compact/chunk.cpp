#include "underbrush/compact/chunk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "underbrush/compact/directions.hpp"
#include "underbrush/compact/exact_math.hpp"

namespace underbrush::compact {
namespace {

constexpr double kGrid = 0x1p24;  // a ray cloud PLY rounds origins to this part of a metre

enum OriginKind : uint8_t { kAsTheyAre, kOnTrack, kOnTrackAndGrid };

// Packs the bits of floating-point values as whole numbers whose order is that of the values.
template <class T, class U>
void pack_ordered(std::span<const T> values, const Order& order, Codec& codec,
                  std::vector<U>& numbers, std::string& out) {
  numbers.resize(values.size());
  for (size_t i = 0; i < values.size(); ++i) numbers[i] = ordered(values[i]);
  codec.pack<U>(numbers, order, out);
}

template <class T, class U>
void unpack_ordered(Cursor& in, const Order& order, Codec& codec, std::vector<U>& numbers,
                    std::span<T> values) {
  numbers.resize(values.size());
  codec.unpack<U>(in, order, numbers);
  for (size_t i = 0; i < values.size(); ++i) values[i] = from_ordered(numbers[i]);
}

template <class T>
void pack(std::span<const T> values, const Order& order, Scratch& s, std::string& out) {
  if constexpr (std::is_same_v<T, float>) {
    pack_ordered(values, order, s.codec, s.words, out);
  } else if constexpr (std::is_same_v<T, double>) {
    pack_ordered(values, order, s.codec, s.longs, out);
  } else {
    using U = std::make_unsigned_t<T>;
    s.codec.pack<U>({reinterpret_cast<const U*>(values.data()), values.size()}, order, out);
  }
}

template <class T>
void unpack(Cursor& in, const Order& order, Scratch& s, std::span<T> values) {
  if constexpr (std::is_same_v<T, float>) {
    unpack_ordered(in, order, s.codec, s.words, values);
  } else if constexpr (std::is_same_v<T, double>) {
    unpack_ordered(in, order, s.codec, s.longs, values);
  } else {
    using U = std::make_unsigned_t<T>;
    s.codec.unpack<U>(in, order, {reinterpret_cast<U*>(values.data()), values.size()});
  }
}

void find_places(const Track& track, std::span<const double> time_s, std::vector<Place>& places) {
  places.resize(track.empty() ? 0 : time_s.size());
  for (size_t i = 0; i < places.size(); ++i) {
    places[i] = i > 0 && time_s[i] == time_s[i - 1] ? places[i - 1] : track.at(time_s[i]);
  }
}

double on_grid(double x) {
  constexpr double kShift = 0x1.8p52;
  return ((x * kGrid + kShift) - kShift) / kGrid;
}

// The number of the predicted coordinate, 0 without a prediction.
uint64_t predicted(OriginKind kind, const std::vector<Place>& places, size_t row, size_t axis) {
  if (kind == kAsTheyAre) return 0;
  const Vector& p = places[row].position;
  double x = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  if (kind == kOnTrackAndGrid) x = on_grid(x);
  return std::abs(x) < 1e300 ? ordered(x) : 0;  // not a number has no bits to rely on
}

double bits_of(uint64_t rest) {
  return double(std::bit_width((rest << 1) ^ uint64_t(int64_t(rest) >> 63)));
}

// The kind of prediction that leaves the fewest bits, tried on some rows.
OriginKind best_kind(std::span<const Vec3> origin, const std::vector<Place>& places) {
  if (places.empty()) return kAsTheyAre;
  constexpr size_t kTried = 256;
  OriginKind best = kAsTheyAre;
  double least = INFINITY;
  for (const OriginKind kind : {kAsTheyAre, kOnTrack, kOnTrackAndGrid}) {
    double bits = 0;
    uint64_t last = 0;
    for (size_t k = 0; k < kTried; ++k) {
      const size_t row = origin.size() * k / kTried;
      const uint64_t rest = ordered(origin[row].x()) - predicted(kind, places, row, 0);
      bits += bits_of(rest - last);
      last = rest;
    }
    if (bits < least) best = kind;
    least = std::min(least, bits);
  }
  return best;
}

void pack_origins(std::span<const Vec3> origin, const Order& order, Scratch& s, std::string& out) {
  const OriginKind kind = best_kind(origin, s.places);
  put(out, kind);
  std::vector<uint64_t>& rest = s.longs;
  rest.resize(origin.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < rest.size(); ++i) {
      rest[i] = ordered(origin[i][Eigen::Index(axis)]) - predicted(kind, s.places, i, axis);
    }
    s.codec.pack<uint64_t>(rest, order, out);
  }
}

void unpack_origins(Cursor& in, const Order& order, Scratch& s, std::span<Vec3> origin) {
  const auto kind = in.get<OriginKind>();
  if (kind > kOnTrackAndGrid || (kind != kAsTheyAre && s.places.empty())) {
    in.fail("it has origins of an unknown kind");
  }
  std::vector<uint64_t>& rest = s.longs;
  rest.resize(origin.size());
  for (size_t axis = 0; axis < 3; ++axis) {
    s.codec.unpack<uint64_t>(in, order, rest);
    for (size_t i = 0; i < rest.size(); ++i) {
      origin[i][Eigen::Index(axis)] = from_ordered(rest[i] + predicted(kind, s.places, i, axis));
    }
  }
}

/// Which rows hold a return, and what is stored for these alone.
struct Returns {
  std::vector<uint32_t> rows;
  Order by_ring;
};

Returns returns_of(const std::vector<uint8_t>& missed, std::span<const uint16_t> ring) {
  Returns out;
  std::vector<uint16_t> rings;
  for (size_t i = 0; i < missed.size(); ++i) {
    if (missed[i]) continue;
    out.rows.push_back(uint32_t(i));
    rings.push_back(ring[i]);
  }
  out.by_ring = order_by_ring(rings);
  return out;
}

std::vector<uint8_t> eights_of(const std::vector<uint8_t>& flags, const Order& order) {
  std::vector<uint8_t> out((flags.size() + 7) / 8, 0);
  for (size_t i = 0; i < flags.size(); ++i) {
    out[i / 8] |= uint8_t(flags[order.empty() ? i : order[i]] << (i % 8));
  }
  return out;
}

// A miss has no range, and no intensity unless one of the chunk's has one.
void pack_returns(const BeamLog& log, size_t begin, size_t n, const Order& order, Scratch& s,
                  std::string& out) {
  std::vector<uint8_t> missed(n);
  bool silent = true;
  for (size_t i = 0; i < n; ++i) {
    missed[i] = log.range_m[begin + i] == kMiss;
    if (missed[i]) silent &= std::bit_cast<uint32_t>(log.intensity[begin + i]) == 0;
  }
  s.codec.pack<uint8_t>(eights_of(missed, order), {}, out);
  const Returns returns = returns_of(missed, {log.ring.data() + begin, n});
  std::vector<float>& values = s.values;
  values.clear();
  for (const uint32_t row : returns.rows) values.push_back(log.range_m[begin + row]);
  pack<float>(values, returns.by_ring, s, out);
  put(out, uint8_t(silent));
  if (!silent) {
    return pack<float>({log.intensity.data() + begin, n}, order, s, out);
  }
  for (size_t k = 0; k < values.size(); ++k) values[k] = log.intensity[begin + returns.rows[k]];
  pack<float>(values, returns.by_ring, s, out);
}

void unpack_returns(Cursor& in, size_t n, const Order& order, Scratch& s, BeamLog& out,
                    size_t begin) {
  std::vector<uint8_t> eights((n + 7) / 8), missed(n);
  s.codec.unpack<uint8_t>(in, {}, eights);
  for (size_t i = 0; i < n; ++i) {
    missed[order.empty() ? i : order[i]] = (eights[i / 8] >> (i % 8)) & 1;
  }
  const Returns returns = returns_of(missed, {out.ring.data() + begin, n});
  std::vector<float>& values = s.values;
  values.resize(returns.rows.size());
  unpack<float>(in, returns.by_ring, s, std::span(values));
  std::fill_n(out.range_m.begin() + std::ptrdiff_t(begin), n, kMiss);
  for (size_t k = 0; k < values.size(); ++k) out.range_m[begin + returns.rows[k]] = values[k];
  if (in.get<uint8_t>() == 0) {
    return unpack<float>(in, order, s, {out.intensity.data() + begin, n});
  }
  unpack<float>(in, returns.by_ring, s, std::span(values));
  std::fill_n(out.intensity.begin() + std::ptrdiff_t(begin), n, 0.0f);
  for (size_t k = 0; k < values.size(); ++k) out.intensity[begin + returns.rows[k]] = values[k];
}

}  // namespace

std::string encoded(const BeamLog& log, const std::vector<ScanInfo>& scans, size_t begin, size_t n,
                    Scratch& s) {
  std::string out;
  const auto part = [&](const auto& column) { return std::span(column.data() + begin, n); };
  const auto ring = part(log.ring);
  const auto time_s = part(log.time_s);
  s.codec.pack<uint16_t>(ring, {}, out);
  const Order order = order_by_ring(ring);
  s.codec.pack<uint32_t>(part(log.scan), order, out);
  s.codec.pack<uint32_t>(part(log.packet), order, out);
  s.codec.pack<uint8_t>(part(log.flags), order, out);
  pack<double>(time_s, order, s, out);
  const auto [first, last] = std::minmax_element(time_s.begin(), time_s.end());
  const Track track(scans, *first, *last);
  track.append_to(out);
  find_places(track, time_s, s.places);
  pack_origins(part(log.origin), order, s, out);
  pack_directions(part(log.direction), {ring, part(log.scan), time_s, s.places, order}, s, out);
  pack_returns(log, begin, n, order, s, out);
  for (const auto& entry : log.extra) {
    std::visit(
        [&](const auto& column) {
          using T = typename std::decay_t<decltype(column)>::value_type;
          pack<T>(part(column), order, s, out);
        },
        entry.second);
  }
  return out;
}

void decode(Cursor& in, size_t n, Scratch& s, BeamLog& out, size_t begin) {
  const auto part = [&](auto& column) { return std::span(column.data() + begin, n); };
  const auto ring = part(out.ring);
  s.codec.unpack<uint16_t>(in, {}, ring);
  const Order order = order_by_ring(ring);
  s.codec.unpack<uint32_t>(in, order, part(out.scan));
  s.codec.unpack<uint32_t>(in, order, part(out.packet));
  s.codec.unpack<uint8_t>(in, order, part(out.flags));
  unpack<double>(in, order, s, part(out.time_s));
  const Track track = Track::read(in);
  find_places(track, part(out.time_s), s.places);
  unpack_origins(in, order, s, part(out.origin));
  unpack_directions(in, {ring, part(out.scan), part(out.time_s), s.places, order}, s,
                    part(out.direction));
  unpack_returns(in, n, order, s, out, begin);
  for (auto& entry : out.extra) {
    std::visit(
        [&](auto& column) {
          using T = typename std::decay_t<decltype(column)>::value_type;
          unpack<T>(in, order, s, part(column));
        },
        entry.second);
  }
}

}  // namespace underbrush::compact
