#include "underbrush/metrics/instances.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::metrics {
namespace {

void add(InstanceCounter& c, uint32_t found, uint32_t truth, int n) {
  for (int k = 0; k < n; ++k) c.add(found, truth);
}

TEST(Instances, AreMatchedFromHalfOfTheirUnionOn) {
  InstanceCounter c;
  add(c, 1, 11, 10), add(c, 1, 0, 5), add(c, 0, 11, 5);  // IoU 10 / 20
  add(c, 2, 12, 10), add(c, 2, 0, 6), add(c, 0, 12, 5);  // 10 / 21
  add(c, 3, 13, 9);
  add(c, 4, 0, 30);   // there is no true object here
  add(c, 0, 15, 40);  // this object was not found
  const InstanceScore s = c.score();
  EXPECT_EQ(s.found, 4u);
  EXPECT_EQ(s.truth, 4u);
  EXPECT_EQ(s.matched, 2u);
  EXPECT_DOUBLE_EQ(s.precision(), 0.5);
  EXPECT_DOUBLE_EQ(s.recall(), 0.5);
  EXPECT_DOUBLE_EQ(s.f1(), 0.5);
  EXPECT_DOUBLE_EQ(s.mean_iou, 0.75);
  EXPECT_EQ(c.score(10).found, 3u);  // the smallest object does not count
}

TEST(Instances, AreMatchedOneToOne) {
  InstanceCounter c;
  add(c, 1, 11, 50), add(c, 2, 11, 50);  // split in two halves
  EXPECT_EQ(c.score().matched, 1u);
  InstanceCounter same;
  for (uint32_t k = 1; k < 100; ++k) add(same, k, 1000 - k, int(k));
  EXPECT_DOUBLE_EQ(same.score().f1(), 1);
  EXPECT_DOUBLE_EQ(same.score().mean_iou, 1);
}

TEST(Instances, NoneGiveNoScore) {
  const InstanceScore s = InstanceCounter().score();
  EXPECT_TRUE(std::isnan(s.precision()));
  EXPECT_TRUE(std::isnan(s.recall()));
  EXPECT_TRUE(std::isnan(s.f1()));
}

}  // namespace
}  // namespace underbrush::metrics
