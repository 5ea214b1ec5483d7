#include "underbrush/perception/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::perception {

// Column `columns_ + row` stands for the row being alone.
double Assignment::cost(uint32_t row, size_t column) const {
  if (column >= columns_) {
    return column - columns_ == row ? alone_ : std::numeric_limits<double>::infinity();
  }
  return cost_[row * columns_ + column];
}

// Dijkstra's algorithm over reduced costs, from a row to the nearest free column. Returns the
// column.
size_t Assignment::shortest_path(uint32_t row) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  distance_.assign(all_, kInfinity);
  before_.assign(all_, kUnassigned);
  done_.assign(all_, 0);
  uint32_t at = row;
  size_t column = all_;
  double reached = 0;
  for (;;) {
    size_t next = all_;
    for (size_t c = 0; c < all_; ++c) {
      if (done_[c]) continue;
      const double d = reached + cost(at, c) - row_price_[at] - column_price_[c];
      if (d < distance_[c]) {
        distance_[c] = d;
        before_[c] = column == all_ ? kUnassigned : uint32_t(column);
      }
      if (next == all_ || distance_[c] < distance_[next]) next = c;
    }
    reached = distance_[next];
    done_[next] = 1;
    column = next;
    if (row_of_[next] == kUnassigned) break;
    at = row_of_[next];
  }
  // The prices change so that all costs on the path become 0.
  row_price_[row] += reached;
  for (size_t c = 0; c < all_; ++c) {
    if (!done_[c] || c == column) continue;
    row_price_[row_of_[c]] += reached - distance_[c];
    column_price_[c] -= reached - distance_[c];
  }
  return column;
}

std::span<const uint32_t> Assignment::solve(std::span<const double> cost, size_t rows,
                                            size_t columns, double alone) {
  require(cost.size() == rows * columns, "assignment: the costs are not rows times columns");
  require(std::none_of(cost.begin(), cost.end(), [](double c) { return std::isnan(c); }),
          "assignment: a cost is not a number");
  cost_ = cost;
  columns_ = columns;
  all_ = columns + rows;
  alone_ = alone;
  row_price_.assign(rows, 0);
  column_price_.assign(all_, 0);
  row_of_.assign(all_, kUnassigned);
  for (uint32_t row = 0; row < rows; ++row) {
    size_t column = shortest_path(row);
    // Every row on the path moves to the next column of it.
    for (uint32_t previous = before_[column]; previous != kUnassigned; previous = before_[column]) {
      row_of_[column] = row_of_[previous];
      column = previous;
    }
    row_of_[column] = row;
  }
  result_.assign(rows, kUnassigned);
  for (size_t c = 0; c < columns; ++c) {
    if (row_of_[c] != kUnassigned) result_[row_of_[c]] = uint32_t(c);
  }
  return result_;
}

}  // namespace underbrush::perception
