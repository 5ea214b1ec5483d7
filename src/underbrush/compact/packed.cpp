#include "underbrush/compact/packed.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

#include "underbrush/core/clones.hpp"

namespace underbrush::compact {
namespace {

constexpr int kLevel = 1;
constexpr size_t kWindows = 8, kWindowRows = 512;  // what the choice of a transform is made on
constexpr size_t kMostDistinct = 256;
constexpr uint8_t kTable = 3, kRingOrder = 8;
enum PlaneKind : uint8_t { kConstant, kStored, kCompressed };

template <class T>
T zigzag(T x) {
  using S = std::make_signed_t<T>;
  return T(T(x << 1) ^ T(S(x) >> (8 * sizeof(T) - 1)));
}

template <class T>
T unzigzag(T x) {
  return T(T(x >> 1) ^ T(T(0) - T(x & 1)));
}

using Histogram = std::array<uint32_t, 256>;

// Bits that an ideal coder needs for bytes with these counts.
double bits_of(const Histogram& count, size_t n) {
  double bits = 0;
  for (const uint32_t c : count) {
    if (c > 0) bits += c * std::log2(double(n) / c);
  }
  return bits;
}

template <class T>
T value_at(std::span<const T> values, const Order& order, size_t i) {
  return order.empty() ? values[i] : values[order[i]];
}

// Estimates the bits that the column takes for 0, 1 and 2 differences, from some windows of rows.
template <class T>
std::array<double, 3> estimates(std::span<const T> values, const Order& order) {
  std::array<std::array<Histogram, sizeof(T)>, 3> count{};
  const size_t windows = std::min(kWindows, values.size() / kWindowRows + 1);
  size_t n = 0;
  for (size_t w = 0; w < windows; ++w) {
    const size_t begin = values.size() * w / windows;
    const size_t end = std::min(values.size(), begin + kWindowRows);
    T last = 0, last_step = 0;
    for (size_t i = begin; i < end; ++i) {
      const T value = value_at(values, order, i), step = T(value - last);
      const std::array<T, 3> shown = {zigzag(value), zigzag(step), zigzag(T(step - last_step))};
      last = value;
      last_step = step;
      if (i < begin + 2 && begin + 2 < end) continue;
      ++n;
      for (size_t k = 0; k < 3; ++k) {
        for (size_t b = 0; b < sizeof(T); ++b) ++count[k][b][uint8_t(shown[k] >> (8 * b))];
      }
    }
  }
  std::array<double, 3> bits{};
  for (size_t k = 0; k < 3; ++k) {
    for (const Histogram& h : count[k]) bits[k] += bits_of(h, n);
    bits[k] *= double(values.size()) / double(std::max<size_t>(n, 1));
  }
  return bits;
}

/// The distinct values of a column in the order of their first rows, and each row's number among
/// them.
template <class T>
struct Table {
  std::vector<T> values;
  std::vector<uint8_t> index;

  /// Returns false where there are more values than a byte can number.
  bool number(std::span<const T> column, const Order& order);
  double bits() const {
    Histogram count{};
    for (const uint8_t k : index) ++count[k];
    return bits_of(count, index.size()) + 8.0 * double(values.size() * sizeof(T));
  }
};

template <class T>
bool Table<T>::number(std::span<const T> column, const Order& order) {
  constexpr size_t kSlots = 1024;
  constexpr uint16_t kFree = 0xffff;
  std::array<uint16_t, kSlots> slots;
  slots.fill(kFree);
  index.resize(column.size());
  for (size_t i = 0; i < column.size(); ++i) {
    const T v = value_at(column, order, i);
    size_t slot = size_t((uint64_t(v) * 0x9e3779b97f4a7c15ull) >> 54);
    while (slots[slot] != kFree && values[slots[slot]] != v) slot = (slot + 1) % kSlots;
    if (slots[slot] == kFree) {
      if (values.size() == kMostDistinct) return false;
      slots[slot] = uint16_t(values.size());
      values.push_back(v);
    }
    index[i] = uint8_t(slots[slot]);
  }
  return true;
}

template <class T>
void put_in_order(std::span<const T> values, const Order& order, std::vector<T>& out) {
  out.assign(values.begin(), values.end());
  for (size_t i = 0; i < order.size(); ++i) out[i] = values[order[i]];
}

template <class T>
UNDERBRUSH_CLONES void plane_of(const T* values, size_t n, int shift, uint8_t* plane) {
  for (size_t i = 0; i < n; ++i) plane[i] = uint8_t(values[i] >> shift);
}

template <class T>
UNDERBRUSH_CLONES void add_plane(const uint8_t* plane, size_t n, int shift, T* values) {
  for (size_t i = 0; i < n; ++i) values[i] = T(values[i] | T(T(plane[i]) << shift));
}

template <class T>
void differences(std::vector<T>& v) {
  for (size_t i = v.size(); i-- > 1;) v[i] = T(v[i] - v[i - 1]);
}

template <class T>
void sums(std::vector<T>& v) {
  for (size_t i = 1; i < v.size(); ++i) v[i] = T(v[i] + v[i - 1]);
}

}  // namespace

Order order_by_ring(std::span<const uint16_t> ring) {
  if (std::is_sorted(ring.begin(), ring.end())) return {};
  std::vector<uint32_t> start(size_t(std::numeric_limits<uint16_t>::max()) + 2, 0);
  for (const uint16_t r : ring) ++start[size_t(r) + 1];
  for (size_t r = 1; r < start.size(); ++r) start[r] += start[r - 1];
  Order order(ring.size());
  for (size_t i = 0; i < ring.size(); ++i) order[start[ring[i]]++] = uint32_t(i);
  return order;
}

struct Codec::State {
  ZSTD_CCtx* compressing = nullptr;
  ZSTD_DCtx* decompressing = nullptr;
  // Kept, because the system clears fresh memory.
  std::string block;
  std::vector<uint8_t> plane;
  std::tuple<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<uint32_t>,
             std::vector<uint64_t>>
      values;
};

Codec::Codec() : state_(std::make_unique<State>()) {}

Codec::~Codec() {
  ZSTD_freeCCtx(state_->compressing);
  ZSTD_freeDCtx(state_->decompressing);
}

std::string_view Codec::deflated(std::string_view bytes) {
  State& s = *state_;
  if (!s.compressing) s.compressing = ZSTD_createCCtx();
  s.block.resize(std::max(s.block.size(), ZSTD_compressBound(bytes.size())));
  const size_t size = ZSTD_compressCCtx(s.compressing, s.block.data(), s.block.size(), bytes.data(),
                                        bytes.size(), kLevel);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the room is enough, so memory was not
  return {s.block.data(), size};
}

void Codec::inflate(std::string_view block, std::span<char> to, const Cursor& in) {
  State& s = *state_;
  if (!s.decompressing) s.decompressing = ZSTD_createDCtx();
  const size_t size =
      ZSTD_decompressDCtx(s.decompressing, to.data(), to.size(), block.data(), block.size());
  if (ZSTD_isError(size) || size != to.size()) in.fail("its compressed content is damaged");
}

void Codec::put_plane(std::span<const uint8_t> plane, std::string& out) {
  Histogram count{};
  for (const uint8_t b : plane) ++count[b];
  if (plane.empty() || count[plane[0]] == plane.size()) {
    put(out, kConstant);
    return put(out, plane.empty() ? uint8_t(0) : plane[0]);
  }
  const std::string_view bytes(reinterpret_cast<const char*>(plane.data()), plane.size());
  constexpr double kNoise = 7.8;  // bits a byte; zstd would gain a fortieth at most
  if (bits_of(count, plane.size()) < kNoise * double(plane.size())) {
    const std::string_view block = deflated(bytes);
    if (block.size() + sizeof(uint32_t) < plane.size()) {
      put(out, kCompressed);
      put(out, uint32_t(block.size()));
      out += block;
      return;
    }
  }
  put(out, kStored);
  out += bytes;
}

template <class T>
void Codec::pack(std::span<const T> values, const Order& by_ring, std::string& out) {
  uint8_t kind = 0;
  double least = INFINITY;
  const Order none;
  for (const bool ring : {false, true}) {
    if (ring && by_ring.empty()) continue;
    const std::array<double, 3> bits = estimates(values, ring ? by_ring : none);
    for (uint8_t k = 0; k < 3; ++k) {
      if (bits[k] >= least) continue;
      least = bits[k];
      kind = uint8_t(k | (ring ? kRingOrder : 0));
    }
  }
  const bool ring = kind & kRingOrder;
  constexpr double kWorthATable = 1.5;  // bits a value
  Table<T> table;
  if (sizeof(T) > 1 && least > kWorthATable * double(values.size()) &&
      table.number(values, ring ? by_ring : none) && table.bits() < least) {
    put(out, uint8_t(kTable | (ring ? kRingOrder : 0)));
    put(out, uint16_t(table.values.size()));
    for (const T v : table.values) put(out, v);
    return put_plane(table.index, out);
  }
  put(out, kind);
  auto& v = std::get<std::vector<T>>(state_->values);
  put_in_order(values, ring ? by_ring : none, v);
  for (int k = 0; k < (kind & 3); ++k) differences(v);
  for (T& x : v) x = zigzag(x);
  std::vector<uint8_t>& plane = state_->plane;
  plane.resize(v.size());
  for (size_t b = 0; b < sizeof(T); ++b) {
    plane_of(v.data(), v.size(), int(8 * b), plane.data());
    put_plane(plane, out);
  }
}

template <class T>
void Codec::unpack(Cursor& in, const Order& by_ring, std::span<T> values) {
  const auto kind = in.get<uint8_t>();
  const uint8_t transform = kind & 3;
  const bool ring = kind & kRingOrder;
  if (kind & ~(kRingOrder | 3)) in.fail("it has a column of an unknown kind");
  const size_t n = values.size();
  std::vector<uint8_t>& buffer = state_->plane;
  // Returns the bytes of the next plane; nothing where all of them are `constant`.
  const auto next_plane = [&](uint8_t& constant) -> const uint8_t* {
    switch (in.get<uint8_t>()) {
      case kConstant:
        constant = in.get<uint8_t>();
        return nullptr;
      case kStored:
        return reinterpret_cast<const uint8_t*>(in.take(n).data());
      case kCompressed:
        buffer.resize(n);
        inflate(in.take(in.get<uint32_t>()), std::span(reinterpret_cast<char*>(buffer.data()), n),
                in);
        return buffer.data();
      default:
        in.fail("it has a plane of an unknown kind");
    }
  };
  auto& v = std::get<std::vector<T>>(state_->values);
  v.assign(n, 0);
  if (transform == kTable) {
    std::vector<T> table(in.get<uint16_t>());
    for (T& x : table) x = in.get<T>();
    uint8_t constant = 0;
    const uint8_t* index = next_plane(constant);
    for (size_t i = 0; i < n; ++i) {
      const size_t k = index ? index[i] : constant;
      if (k >= table.size()) in.fail("it has an index beyond its table");
      v[i] = table[k];
    }
  } else {
    for (size_t b = 0; b < sizeof(T); ++b) {
      uint8_t constant = 0;
      const uint8_t* plane = next_plane(constant);
      if (plane) {
        add_plane(plane, n, int(8 * b), v.data());
      } else if (constant != 0) {
        for (T& x : v) x = T(x | T(T(constant) << (8 * b)));
      }
    }
    for (T& x : v) x = unzigzag(x);
    for (int k = 0; k < transform; ++k) sums(v);
  }
  if (ring && !by_ring.empty()) {
    for (size_t i = 0; i < n; ++i) values[by_ring[i]] = v[i];
  } else {
    std::copy(v.begin(), v.end(), values.begin());
  }
}

#define UNDERBRUSH_PACKED(T)                                                    \
  template void Codec::pack<T>(std::span<const T>, const Order&, std::string&); \
  template void Codec::unpack<T>(Cursor&, const Order&, std::span<T>)
UNDERBRUSH_PACKED(uint8_t);
UNDERBRUSH_PACKED(uint16_t);
UNDERBRUSH_PACKED(uint32_t);
UNDERBRUSH_PACKED(uint64_t);
#undef UNDERBRUSH_PACKED

}  // namespace underbrush::compact
