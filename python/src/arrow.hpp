/// \file
/// Tables in memory that other libraries read as Arrow's, by the PyCapsule interface: a capsule
/// holds a struct of Arrow's C data interface, whose layout Arrow's specification fixes.
#pragma once
#include <nanobind/nanobind.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace underbrush::python {
namespace nb = nanobind;

/// A column of numbers, or of lists that all have `width` numbers.
struct ArrowColumn {
  std::string name;
  std::string format;  ///< Arrow's letter of the type of a number, such as "g" for float64.
  int width = 0;       ///< Numbers of a row's list; 0 for rows that are numbers.
  const void* values = nullptr;
  const void* valid = nullptr;  ///< One bit per row, 0 for a null; null where all rows have values.
  int64_t nulls = 0;
};

/// Columns of equal length. `owner` keeps their memory until the last reader has released it.
struct ArrowTable {
  std::vector<ArrowColumn> columns;
  int64_t rows = 0;
  std::shared_ptr<const void> owner;
  std::string metadata = {};  ///< JSON; the value of the schema's key "underbrush".
};

/// Returns Arrow's letter of a type of numbers.
template <class T>
const char* arrow_format() {
  if constexpr (std::is_same_v<T, double>) return "g";
  if constexpr (std::is_same_v<T, float>) return "f";
  constexpr const char* kSigned[] = {"c", "s", "i"};
  constexpr const char* kUnsigned[] = {"C", "S", "I"};
  constexpr int k = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : 2;
  return std::is_signed_v<T> ? kSigned[k] : kUnsigned[k];
}

/// Returns an owner that keeps a Python object alive; any thread may release it.
std::shared_ptr<const void> kept_alive(nb::handle object);

/// Returns the next table of a stream, with the columns of the first; nothing at the end.
using ArrowNext = std::function<std::optional<ArrowTable>()>;

/// Returns the capsule that `__arrow_c_schema__` gives.
nb::object arrow_schema(const ArrowTable& table);
/// Returns the capsules, of a schema and an array, that `__arrow_c_array__` gives.
nb::object arrow_array(const ArrowTable& table);
/// Returns the capsule that `__arrow_c_stream__` gives: the first table, then those of `next`,
/// which is called without Python's lock.
nb::object arrow_stream(ArrowTable first, ArrowNext next = {});

}  // namespace underbrush::python
