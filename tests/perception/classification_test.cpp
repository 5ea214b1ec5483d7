#include "underbrush/perception/classification.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"

namespace underbrush::perception {
namespace {

SegmentShape shape_of(const Vec3& size, double yaw, uint32_t points = 200) {
  const OrientedBox box{{15, 6, 0.9}, yaw, size};
  SegmentShape shape =
      ShapeFitter::measure(test::seen_sides(box, Vec3(0, 0, 1)), yaw, Vec3(0, 0, 1));
  shape.points = points;
  return shape;
}

ObjectClass decided(const Vec3& size, double speed, uint32_t points = 200, int cycles = 5) {
  const Classification classification({}, {});
  ClassEvidence evidence;
  for (int k = 0; k < cycles; ++k) {
    classification.observe(shape_of(size, 0.5, points), speed, evidence);
  }
  return classification.decide(classification.probabilities(evidence));
}

TEST(Classification, TellsClassesBySizeAndSpeed) {
  EXPECT_EQ(decided({4.5, 1.8, 1.5}, 8), ObjectClass::kCar);
  EXPECT_EQ(decided({10, 2.5, 3.3}, 8), ObjectClass::kTruck);
  EXPECT_EQ(decided({0.7, 0.65, 1.75}, 1.4), ObjectClass::kPedestrian);
  EXPECT_EQ(decided({1.75, 0.65, 1.7}, 5), ObjectClass::kCyclist);
  EXPECT_EQ(decided({7, 5, 2.5}, 0), ObjectClass::kOther);
}

TEST(Classification, ProbabilitiesSumToOneAndBeginAtThePrior) {
  ClassificationOptions options;
  const Classification classification(options, {});
  const auto p = classification.probabilities({});
  float sum = 0;
  for (const float x : p) sum += x;
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_NEAR(double(p[size_t(ObjectClass::kCar)]), options.prior[1], 1e-6);
  EXPECT_EQ(p[0], 0);
}

TEST(Classification, FewPointsShowLittle) {
  const Classification classification({}, {});
  ClassEvidence few, many;
  classification.observe(shape_of({4.5, 1.8, 1.5}, 0.5, 2), 5, few);
  classification.observe(shape_of({4.5, 1.8, 1.5}, 0.5, 2000), 5, many);
  const auto car = size_t(ObjectClass::kCar);
  EXPECT_LT(classification.probabilities(few)[car], classification.probabilities(many)[car]);
}

}  // namespace
}  // namespace underbrush::perception
