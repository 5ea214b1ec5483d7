#include "underbrush/perception/existence.hpp"

#include <gtest/gtest.h>

namespace underbrush::perception {
namespace {

constexpr auto kCar = ObjectClass::kCar;

TEST(Existence, FollowsThePublishedNumbers) {
  const ExistenceOptions options;
  Existence e;
  e.update(options, kCar, 100, 2);
  EXPECT_FALSE(e.is_listed());
  e.update(options, kCar, 100, 2);
  EXPECT_FALSE(e.is_listed());
  e.update(options, kCar, 100, 2);
  EXPECT_TRUE(e.is_listed()) << "confirmed in the third cycle";
  EXPECT_NEAR(e.probability(), 0.6, 1e-12);
  e.update(options, kCar, 100, 2);
  e.update(options, kCar, 100, 2);
  EXPECT_DOUBLE_EQ(e.probability(), 1);
  for (int cycle = 1; cycle <= 9; ++cycle) {
    e.update(options, kCar, 0, 0);
    EXPECT_TRUE(e.is_listed()) << "coasts, cycle " << cycle;
  }
  EXPECT_NEAR(e.probability(), 0.505, 1e-12);
  e.update(options, kCar, 0, 0);
  EXPECT_FALSE(e.is_listed()) << "dropped in the tenth cycle";
}

TEST(Existence, NeedsMoreThanThreePointsToBeginAndOneToStay) {
  const ExistenceOptions options;
  Existence e;
  for (int k = 0; k < 20; ++k) e.update(options, kCar, 3, 1);
  EXPECT_EQ(e.probability(), 0);
  for (int k = 0; k < 3; ++k) e.update(options, kCar, 4, 1);
  EXPECT_TRUE(e.is_listed());
  for (int k = 0; k < 20; ++k) e.update(options, kCar, 1, 0);
  EXPECT_TRUE(e.is_listed());
  EXPECT_DOUBLE_EQ(e.probability(), 1);
}

TEST(Existence, StepsDependOnTheClass) {
  ExistenceOptions options;
  options.by_class[size_t(ObjectClass::kPedestrian)] = ExistenceStep{0.5, 0.5, 0};
  Existence person, car;
  person.update(options, ObjectClass::kPedestrian, 1, 0.4);
  car.update(options, kCar, 1, 0.4);
  EXPECT_TRUE(person.is_listed());
  EXPECT_EQ(car.probability(), 0);
}

TEST(Existence, SmallSegmentsGainInProportion) {
  ExistenceOptions options;
  options.full_extent_m = 2;
  Existence e;
  e.update(options, kCar, 10, 0.5);
  EXPECT_NEAR(e.probability(), 0.05, 1e-12);
  e.update(options, kCar, 10, 5);
  EXPECT_NEAR(e.probability(), 0.25, 1e-12);
}

TEST(Existence, FiveInARow) {
  ExistenceOptions options;
  options.rule = ExistenceRule::kInARow;
  Existence e;
  const auto see = [&](uint32_t points) { e.update(options, kCar, points, 1); };
  for (int k = 0; k < 4; ++k) see(9);
  see(0);
  for (int k = 0; k < 4; ++k) see(9);
  EXPECT_FALSE(e.is_listed());
  see(9);
  EXPECT_TRUE(e.is_listed());
  for (int k = 0; k < 9; ++k) see(0);
  EXPECT_TRUE(e.is_listed());
  see(0);
  EXPECT_FALSE(e.is_listed());
  EXPECT_TRUE(e.is_gone(options));
}

TEST(Existence, FiveOfTen) {
  ExistenceOptions options;
  options.rule = ExistenceRule::kOutOf;
  Existence e;
  // Every other cycle: the fifth detection is in the ninth cycle.
  for (int cycle = 1; cycle <= 8; ++cycle) e.update(options, kCar, cycle % 2 ? 9 : 0, 1);
  EXPECT_FALSE(e.is_listed());
  e.update(options, kCar, 9, 1);
  EXPECT_TRUE(e.is_listed());
  // Every third cycle there are never five of ten.
  Existence rare;
  for (int cycle = 1; cycle <= 60; ++cycle) rare.update(options, kCar, cycle % 3 ? 0 : 9, 1);
  EXPECT_FALSE(rare.is_listed());
}

TEST(Existence, RefusesOptionsOutOfRange) {
  ExistenceOptions options;
  options.window = 40;
  EXPECT_THROW(options.check(), std::invalid_argument);
  options = {};
  options.step.gain = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::perception
