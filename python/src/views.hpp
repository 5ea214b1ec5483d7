/// \file
/// NumPy views of columns that C++ owns. A view keeps its owner alive, and nothing is copied.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <type_traits>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::python {
namespace nb = nanobind;

template <class T>
using Column = nb::ndarray<nb::numpy, T, nb::ndim<1>>;
template <class T, int Width>
using Rows = nb::ndarray<nb::numpy, T, nb::shape<-1, Width>>;

/// Returns a view of a column; `T` is const for a view that cannot be written.
template <class T, class Vector>
Column<T> view(Vector& column, nb::handle owner) {
  return Column<T>(column.data(), {column.size()}, owner);
}

/// Returns a view of the rows of `Width` numbers of which a column's entries consist.
template <class T, int Width, class Vector>
Rows<T, Width> view_rows(Vector& column, nb::handle owner) {
  static_assert(sizeof(typename Vector::value_type) == Width * sizeof(T));
  return Rows<T, Width>(reinterpret_cast<T*>(column.data()), {column.size(), Width}, owner);
}

/// Returns a view of one number of each struct in `column`; `member` returns its place in a struct.
template <class Struct, class Member>
auto view_member(const std::vector<Struct>& column, Member member, nb::handle owner) {
  using T = std::remove_pointer_t<std::invoke_result_t<Member, const Struct&>>;
  static_assert(sizeof(Struct) % sizeof(T) == 0);
  T* first = column.empty() ? nullptr : member(column.front());
  return Column<T>(first, {column.size()}, owner, {int64_t(sizeof(Struct) / sizeof(T))});
}

/// Returns a view of `Width` neighbouring numbers of each struct in `column`.
template <int Width, class Struct, class Member>
auto view_member_rows(const std::vector<Struct>& column, Member member, nb::handle owner) {
  using T = std::remove_pointer_t<std::invoke_result_t<Member, const Struct&>>;
  static_assert(sizeof(Struct) % sizeof(T) == 0);
  T* first = column.empty() ? nullptr : member(column.front());
  return Rows<T, Width>(first, {column.size(), Width}, owner,
                        {int64_t(sizeof(Struct) / sizeof(T)), 1});
}

/// Returns a new array of `Width` columns that owns its numbers; `rows` receives their place.
template <int Width, class T>
Rows<T, Width> new_rows(size_t n, T*& rows) {
  rows = new T[n * Width];
  nb::capsule owner(rows, [](void* p) noexcept { delete[] static_cast<T*>(p); });
  return Rows<T, Width>(rows, {n, Width}, owner);
}

}  // namespace underbrush::python
