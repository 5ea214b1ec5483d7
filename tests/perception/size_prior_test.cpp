#include "underbrush/perception/size_prior.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"

namespace underbrush::perception {
namespace {

double normal_density(double x, double mean, double sigma) {
  const double u = (x - mean) / sigma;
  return std::exp(-u * u / 2) / (sigma * std::sqrt(2 * M_PI));
}

// The posterior of the extent by integration over all lengths.
Estimate integrated(double m, const Estimate& prior, double s, double hidden) {
  double sum = 0, first = 0, second = 0;
  const double step = 1e-4;
  for (double length = step / 2; length < 12; length += step) {
    const double seen = (1 - hidden) * normal_density(m, length, s);
    // The share of the hidden part is uniform; its density is taken at the prior's mean.
    const double cut = length >= m ? hidden / prior.mean : 0;
    const double w = normal_density(length, prior.mean, prior.sigma) * (seen + cut);
    sum += w;
    first += w * length;
    second += w * length * length;
  }
  const double mean = first / sum;
  return {mean, std::sqrt(second / sum - mean * mean)};
}

TEST(CompleteExtent, IsThePosterior) {
  const Estimate prior{4.5, 0.35};
  for (const double m : {0.8, 2.0, 4.0, 4.4, 4.9, 5.5}) {
    for (const double hidden : {0.0, 0.2, 1.0}) {
      const Estimate e = complete_extent(m, prior, 0.1, hidden);
      const Estimate slow = integrated(m, prior, 0.1, hidden);
      if (hidden == 0 && m < 2.5) continue;  // The integral is of numbers too small.
      EXPECT_NEAR(e.mean, slow.mean, 2e-3) << m << " " << hidden;
      EXPECT_NEAR(e.sigma, slow.sigma, 2e-3) << m << " " << hidden;
    }
  }
}

TEST(CompleteExtent, GrowsWithTheMeasurementAndIsNeverBelowIt) {
  const Estimate prior{4.5, 0.35};
  double last = 0;
  for (double m = 0.1; m < 9; m += 0.1) {
    const double mean = complete_extent(m, prior, 0.1, 1).mean;
    EXPECT_GE(mean, m);
    EXPECT_GE(mean, last - 1e-9);
    last = mean;
  }
}

TEST(ExtentDensity, IsADensity) {
  double sum = 0;
  for (double m = 0.0005; m < 12; m += 0.001) {
    sum += 0.001 * extent_density(m, {4.5, 0.35}, 0.1, 0.3);
  }
  EXPECT_NEAR(sum, 1, 1e-4);
}

TEST(Complete, ACarSeenFromBehindHasItsLength) {
  const OrientedBox car{{15, 0, 0.75}, 0, {4.6, 1.8, 1.5}};
  const Vec3 viewpoint(0, 0, 1);
  const auto points = test::seen_sides(car, viewpoint);
  const SegmentShape shape = ShapeFitter::measure(points, 0, viewpoint);
  EXPECT_LT(shape.box.size_m.x(), 0.8);
  const CompletedBox whole = complete(shape, ObjectClass::kCar, {});
  EXPECT_NEAR(whole.box.size_m.x(), 4.6, 0.3);
  EXPECT_NEAR(whole.box.size_m.y(), 1.8, 0.1);
  EXPECT_LT((whole.box.centre_m - car.centre_m).head<2>().norm(), 0.2);
  EXPECT_GT(whole.sigma_m.x(), 0.2) << "the length is not known well";
  EXPECT_LT(whole.sigma_m.y(), 0.12) << "the width is";
  // The rear stays where it was seen.
  EXPECT_NEAR(whole.box.centre_m.x() - whole.box.size_m.x() / 2, 12.7, 1e-6);
}

TEST(Complete, WhatIsNotKnownStaysAsMeasured) {
  const OrientedBox box{{15, 3, 0.75}, 0.2, {4.6, 1.8, 1.5}};
  const SegmentShape shape =
      ShapeFitter::measure(test::seen_sides(box, Vec3::Zero()), 0.2, Vec3::Zero());
  CompletionOptions off;
  off.enabled = false;
  EXPECT_EQ(complete(shape, ObjectClass::kOther, {}).box.size_m, shape.box.size_m);
  EXPECT_EQ(complete(shape, ObjectClass::kCar, off).box.size_m, shape.box.size_m);
}

TEST(VisibleSides, ACornerShowsBothAndTheRearOne) {
  SegmentShape shape;
  shape.box.size_m = {4, 2, 1.5};
  shape.viewpoint_m = {-10, -8, 0};
  EXPECT_EQ(visible_sides(shape, 0.2), (std::array<bool, 2>{true, true}));
  shape.viewpoint_m = {-10, 0.5, 0};
  EXPECT_EQ(visible_sides(shape, 0.2), (std::array<bool, 2>{false, true}));
  shape.viewpoint_m = {-20, 2, 0};
  EXPECT_EQ(visible_sides(shape, 0.2), (std::array<bool, 2>{false, true})) << "at a grazing angle";
}

}  // namespace
}  // namespace underbrush::perception
