#include "underbrush/trace/crossed_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "maps.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::trace {
namespace {

using elements::ObservedBlock;
using elements::ObservedSpace;

TEST(CrossedCells, AreThoseOfTheMapInAnyBlock) {
  ObservedSpace space;
  Stream random(5);
  for (int32_t x = -9; x < 9; ++x) {
    for (int32_t y = -9; y < 9; y += 2) {
      ObservedBlock block;
      block.at = {x, y, x - y};
      for (uint8_t& n : block.beams)
        n = uint8_t(random.uniform() < 0.5 ? 0 : 1 + 254 * random.uniform());
      space.blocks.push_back(block);
    }
  }
  const CrossedCells crossed(space);
  for (const ObservedBlock& b : space.blocks) {
    for (int32_t k = 0; k < int32_t(ObservedBlock::kCells); ++k) {
      const Cell3 cell{8 * b.at.x + k % 8, 8 * b.at.y + k / 8 % 8, 8 * b.at.z + k / 64};
      ASSERT_EQ(crossed.holds(cell), b.beams[size_t(k)] > 0);
      ASSERT_FALSE(crossed.holds({cell.x, cell.y + 8, cell.z}));  // a block that is not there
    }
  }
}

TEST(CrossedCells, ALineThatSurelyLiesInThemHasNoOtherCell) {
  // Matter lies between heights that change from cell to cell.
  const auto matter = [](int32_t x, int32_t y) {
    return CrossedCells::Layers{-6 + (x & 3), 5 + (y & 3)};
  };
  const ObservedSpace space = space_with_holes(40, 5e-4);  // more than one square
  const CrossedCells crossed(space, [&](int32_t x, int32_t y) {
    CrossedCells::ColumnLayers out;
    for (int32_t k = 0; k < 64; ++k) out[size_t(k)] = matter(x + k % 8, y + k / 8);
    return out;
  });
  Stream random(54);
  size_t sure = 0, all = 0;
  for (int k = 0; k < 200000; ++k) {
    const Vec3 from(random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-20, 20));
    const double angle = random.uniform(0, 2 * M_PI), rise = 0.3 * random.normal();
    const Vec3 way = 8 * Vec3(std::cos(angle), std::sin(angle), rise).normalized();
    const uint32_t falls = uint32_t(way.x() < 0) | uint32_t(way.y() < 0) << 1;
    bool expected = true;
    StepCells cells;
    cells_of_steps(from, way / 8, 0, 1, 1, cells);
    for (int step = 0; step < StepCells::kSteps; ++step) {
      const Cell3 c = cells.of(step);
      ASSERT_EQ(c, cell_of(Vec3(from + (step + 0.5) * way / 8), 1));
      const CrossedCells::Layers with = matter(c.x, c.y);
      const auto is_crossed = [&] {
        const auto at = std::find_if(space.blocks.begin(), space.blocks.end(),
                                     [&](const auto& b) { return b.at == ObservedBlock::of(c); });
        return at != space.blocks.end() && at->beams[ObservedBlock::index(c)] > 0;
      };
      if (k < 1000) {
        const bool in_map =
            std::abs(c.x + 0.5) < 160 && std::abs(c.y + 0.5) < 160 && c.z >= -16 && c.z < 16;
        const bool without = c.z < with.first || c.z > with.last;
        ASSERT_EQ(crossed.holds(c), in_map && (without || is_crossed())) << k;
        ASSERT_EQ(crossed.among(cells) >> step & 1, crossed.holds(c)) << k;
      }
      // Above the map of a column there is no matter either.
      expected = expected && (crossed.holds(c) || c.z > 8);
    }
    const Cell3 begin = cell_of(from, 1), end = cell_of(Vec3(from + way), 1);
    const bool is_sure = CrossedCells::Way(crossed, falls).surely_crossed(begin, end);
    ASSERT_TRUE(expected || !is_sure) << k;
    sure += is_sure;
    all += expected;
  }
  EXPECT_GT(double(sure), 0.5 * double(all));
}

}  // namespace
}  // namespace underbrush::trace
