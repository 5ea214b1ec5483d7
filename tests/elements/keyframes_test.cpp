// Tests of the image of keyframes: where directions lie in it, what is refused, and how ranges
// agree.
#include "underbrush/elements/keyframes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::elements {
namespace {

TEST(KeyframeGrid, FindsRowsAndColumnsOfDirections) {
  Keyframes k;
  k.elevation = {-0.4, -0.2, -0.1, 0.05, 0.3};
  k.columns = 360;
  const KeyframeGrid grid(k);
  for (size_t row = 0; row < k.rows(); ++row) {
    for (int degree = 0; degree < 360; degree += 7) {
      const double azimuth = (degree + 0.5) * M_PI / 180, e = k.elevation[row];
      const Vec3 d(std::cos(e) * std::cos(azimuth), std::cos(e) * std::sin(azimuth), std::sin(e));
      const auto at = grid.place(3.7 * d);
      EXPECT_NEAR(at.row, double(row) + 0.5, 1e-3);
      EXPECT_NEAR(at.column, degree + 0.5, 1e-3);
    }
  }
  EXPECT_LT(grid.place(Vec3(0, 0, 1)).row, 0);
  EXPECT_NEAR(grid.place(Vec3(std::cos(0.125), 0, -std::sin(0.125))).row, 2.25, 1e-3);
}

TEST(KeyframeGrid, RefusesWhatIsNoMixture) {
  Keyframes k;
  k.elevation = {0, 0.1};
  k.columns = 4;
  k.unit_m = 0.01;
  EXPECT_NO_THROW(k.check());
  k.weights[3].elements = 0.5;
  EXPECT_THROW(k.check(), std::invalid_argument);
  k.weights[3].pixel[0] = 0.5;
  k.weights[3].scale = {0.5, 0.25, 0.25};
  EXPECT_NO_THROW(k.check());
  k.elevation = {0.1, 0};
  EXPECT_THROW(k.check(), std::invalid_argument);
}

TEST(KeyframeGrid, TellsHowRangesAgree) {
  const double far = HUGE_VAL;
  const auto of = [](std::vector<double> r) { return agreement(r.data(), r.size()); };
  EXPECT_EQ(of({far, far}), 0u);
  EXPECT_EQ(of({far, far, 3}), 1u);
  EXPECT_EQ(of({far, 3, 3}), 2u);
  EXPECT_EQ(of({3, 3.1}), 3u);
  EXPECT_EQ(of({3, 3.4}), 4u);
  EXPECT_EQ(of({3, 4}), 5u);
  EXPECT_EQ(of({3, 9}), 6u);
}

}  // namespace
}  // namespace underbrush::elements
