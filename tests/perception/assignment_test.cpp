#include "underbrush/perception/assignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "underbrush/core/rng.hpp"

namespace underbrush::perception {
namespace {

// The least sum, by trying every assignment.
double least(const std::vector<double>& cost, size_t rows, size_t columns, double alone,
             size_t row = 0, uint32_t used = 0) {
  if (row == rows) return 0;
  double best = alone + least(cost, rows, columns, alone, row + 1, used);
  for (size_t c = 0; c < columns; ++c) {
    if (used >> c & 1) continue;
    best = std::min(
        best, cost[row * columns + c] + least(cost, rows, columns, alone, row + 1, used | 1u << c));
  }
  return best;
}

TEST(Assignment, HasTheLeastSumOfAllAssignments) {
  Stream random(5);
  Assignment assignment;
  for (int trial = 0; trial < 300; ++trial) {
    const size_t rows = random.below(6), columns = random.below(6);
    std::vector<double> cost;
    for (size_t k = 0; k < rows * columns; ++k) {
      const bool barred = random.uniform() < 0.2;
      const double value = random.uniform(-2, 10);
      cost.push_back(barred ? std::numeric_limits<double>::infinity() : value);
    }
    const auto partner = assignment.solve(cost, rows, columns, 6);
    std::set<uint32_t> taken;
    double sum = 0;
    for (size_t r = 0; r < rows; ++r) {
      if (partner[r] == kUnassigned) {
        sum += 6;
        continue;
      }
      EXPECT_TRUE(taken.insert(partner[r]).second) << "a column twice";
      sum += cost[r * columns + partner[r]];
    }
    EXPECT_NEAR(sum, least(cost, rows, columns, 6), 1e-9) << rows << " x " << columns;
  }
}

TEST(Assignment, APermutationOfTheRowsPermutesTheAnswer) {
  Stream random(6);
  std::vector<double> cost, turned;
  constexpr size_t kN = 40;
  for (size_t k = 0; k < kN * kN; ++k) cost.push_back(random.uniform());
  for (size_t r = 0; r < kN; ++r) {
    const auto* row = &cost[(kN - 1 - r) * kN];
    turned.insert(turned.end(), row, row + kN);
  }
  Assignment assignment;
  const auto first = assignment.solve(cost, kN, kN, 10);
  const std::vector<uint32_t> plain(first.begin(), first.end());
  const auto second = assignment.solve(turned, kN, kN, 10);
  for (size_t r = 0; r < kN; ++r) EXPECT_EQ(plain[kN - 1 - r], second[r]);
}

TEST(Assignment, RefusesCostsThatAreNoNumbers) {
  Assignment assignment;
  const std::vector<double> cost{NAN};
  EXPECT_THROW(assignment.solve(cost, 1, 1, 1), std::invalid_argument);
  EXPECT_THROW(assignment.solve(cost, 2, 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::perception
