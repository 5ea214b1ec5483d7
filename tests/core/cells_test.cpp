#include "underbrush/core/cells.hpp"

#include <gtest/gtest.h>

namespace underbrush {
namespace {

TEST(Cells, HoldTheirLowerEdgeAndNotTheirUpperOne) {
  EXPECT_EQ(cell_of(0, -0.1, 2), (Cell2{0, -1}));
  EXPECT_EQ(cell_of(2, 1.999, 2), (Cell2{1, 0}));
  EXPECT_EQ(cell_of(Vec3(-2, -2.001, 3.9), 2), (Cell3{-1, -2, 1}));
}

TEST(Cells, AMapKeepsCellsApartThatDifferInOneCoordinateOrItsSign) {
  CellMap<Cell3, int> map;
  int n = 0;
  for (int32_t x = -4; x <= 4; ++x) {
    for (int32_t y = -4; y <= 4; ++y) {
      for (int32_t z = -4; z <= 4; ++z) map[{x, y, z}] = n++;
    }
  }
  EXPECT_EQ(map.size(), 729u);
  EXPECT_EQ((map.at({-4, -4, -3})), 1);
  EXPECT_EQ((map.at({4, 4, 4})), 728);
}

}  // namespace
}  // namespace underbrush
