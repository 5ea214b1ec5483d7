/// \file
/// The median of values.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace underbrush {

/// The median of values, the upper of the two middle ones of an even number; `of_none` if there are
/// none.
template <class T>
T median(std::vector<T> values, T of_none = T()) {
  if (values.empty()) return of_none;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace underbrush
