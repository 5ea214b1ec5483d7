/// \file
/// This file assigns rows to columns at the least cost.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace underbrush::perception {

/// A row or column without a partner.
inline constexpr uint32_t kUnassigned = UINT32_MAX;

/// Solves the assignment problem by shortest augmenting paths with potentials (the Hungarian
/// method, [kuhn55], in the form of [crouse16]), in O(r² (r + c)) for r rows and c columns. It
/// keeps its memory from one call to the next. Libraries that have the method either allocate in
/// every call or take whole numbers and square problems only.
class Assignment {
 public:
  /// Assigns each row to one column at most, and each column to one row at most. A row may stay
  /// alone at the cost `alone`, so that no pair costs more than this. `cost` is row by row; an
  /// entry may be infinite. Returns the column of each row, or `kUnassigned`; the sum of all costs
  /// is the least. Throws `std::invalid_argument` where the size of `cost` is not rows · columns,
  /// or an entry is NaN.
  std::span<const uint32_t> solve(std::span<const double> cost, size_t rows, size_t columns,
                                  double alone);

 private:
  size_t shortest_path(uint32_t row);
  double cost(uint32_t row, size_t column) const;

  std::span<const double> cost_;
  size_t columns_ = 0, all_ = 0;
  double alone_ = 0;
  std::vector<double> row_price_, column_price_, distance_;
  std::vector<uint32_t> row_of_, before_, result_;
  std::vector<uint8_t> done_;
};

}  // namespace underbrush::perception
