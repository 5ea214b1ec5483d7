/// \file
/// The header of a PLY file, and its types of values.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::io {

/// Types of values, in the order of the alternatives of `ExtraColumn`.
enum class ValueType : uint8_t { kU8, kU16, kU32, kI8, kI16, kI32, kF32, kF64 };

/// Returns the size (bytes) of a value.
constexpr size_t size_of(ValueType type) {
  constexpr size_t kSizes[] = {1, 2, 4, 1, 2, 4, 4, 8};
  return kSizes[size_t(type)];
}
/// Returns the type of a column's values.
inline ValueType type_of(const ExtraColumn& column) { return ValueType(column.index()); }
/// Returns an empty column of that type.
ExtraColumn column_of(ValueType type);
/// Returns a column's length.
inline size_t length_of(const ExtraColumn& column) {
  return std::visit([](const auto& c) { return c.size(); }, column);
}
/// Converts a column to doubles.
inline std::vector<double> doubles_of(const ExtraColumn& column) {
  return std::visit([](const auto& c) { return std::vector<double>(c.begin(), c.end()); }, column);
}
/// Returns the PLY name of a type ("uchar", "double", …).
const char* ply_name(ValueType type);

/// Reads the value at `bytes`, which is big-endian if `swap`, else little-endian.
template <class T>
T load(const char* bytes, bool swap = false) {
  static_assert(std::endian::native == std::endian::little);
  char raw[sizeof(T)];
  std::memcpy(raw, bytes, sizeof(T));
  if (swap) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

/// Calls `f(T{})` with the C++ type of `type`.
template <class F>
auto with_type(ValueType type, F f) {
  switch (type) {
    case ValueType::kU8:
      return f(uint8_t{});
    case ValueType::kU16:
      return f(uint16_t{});
    case ValueType::kU32:
      return f(uint32_t{});
    case ValueType::kI8:
      return f(int8_t{});
    case ValueType::kI16:
      return f(int16_t{});
    case ValueType::kI32:
      return f(int32_t{});
    case ValueType::kF32:
      return f(float{});
    default:
      return f(double{});
  }
}

/// A property of an element: a value, or a list of values preceded by their number.
struct PlyProperty {
  std::string name;
  ValueType type = ValueType::kF32;
  bool is_list = false;
  ValueType count_type = ValueType::kU8;
};

/// The content of a PLY header.
struct PlyHeader {
  enum class Format { kAscii, kLittle, kBig };
  /// An element that the header declares.
  struct Element {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;
    /// Returns the size (bytes) of a row; a list counts with its length field alone.
    size_t row_size() const;
    bool has_list() const;
  };
  Format format = Format::kLittle;
  std::vector<std::string> comments;  ///< The text behind "comment ".
  std::vector<Element> elements;
  uint64_t body = 0;  ///< Offset (bytes) at which the values begin.
};

/// Reads the header. Throws `FormatError` where it is damaged, or an element's rows cannot fit into
/// the file.
PlyHeader read_ply_header(const InputFile& file);

}  // namespace underbrush::io
