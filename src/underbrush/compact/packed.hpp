/// \file
/// Columns of whole numbers as bytes: differences of neighbours, split into planes of bytes, each
/// plane compressed by zstd. The layout is described in docs/reference/compact-log.md.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "underbrush/compact/cursor.hpp"

namespace underbrush::compact {

/// The order in which a column's rows are stored: `order[i]` is the row of place i. An empty order
/// keeps the rows as they are.
using Order = std::vector<uint32_t>;

/// Returns the rows sorted by ring; rows of one ring keep their order. The result is empty where
/// the rows are sorted already.
Order order_by_ring(std::span<const uint16_t> ring);

/// A compressor and decompressor, which keeps the memory of zstd from one call to the next. Only
/// one thread may use it at a time.
class Codec {
 public:
  Codec();
  ~Codec();
  Codec(const Codec&) = delete;
  Codec& operator=(const Codec&) = delete;

  /// Appends a column. Values are unsigned; the order of their rows is either the given one or
  /// `by_ring`, whichever seems to compress better.
  template <class T>
  void pack(std::span<const T> values, const Order& by_ring, std::string& out);
  /// Reads a column that `pack` wrote with the same number of values and the same `by_ring`.
  template <class T>
  void unpack(Cursor& in, const Order& by_ring, std::span<T> values);

  /// Returns bytes compressed as one block, which stays until the next call.
  std::string_view deflated(std::string_view bytes);
  /// Fills `to` with a block; fails by `in` unless the block has exactly that many bytes.
  void inflate(std::string_view block, std::span<char> to, const Cursor& in);

 private:
  void put_plane(std::span<const uint8_t> plane, std::string& out);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace underbrush::compact
