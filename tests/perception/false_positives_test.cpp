#include "underbrush/perception/false_positives.hpp"

#include <gtest/gtest.h>

#include <set>

namespace underbrush::perception {
namespace {

FalsePositiveOptions busy() {
  FalsePositiveOptions options;
  options.rate_per_s = 4;
  options.mean_life_s = 0.7;
  return options;
}

TEST(FalsePositives, HaveTheRateAndTheLifeThatWereAskedFor) {
  FalsePositives maker(busy(), 3);
  std::set<uint64_t> ids;
  size_t shown = 0;
  constexpr int kCycles = 20000;
  constexpr double kStep = 0.05;
  for (int k = 0; k < kCycles; ++k) {
    ObjectList list;
    list.time_s = k * kStep;
    maker.step(list);
    shown += list.objects.size();
    for (const auto& o : list.objects) {
      ids.insert(o.id);
      const double range = o.box.centre_m.head<2>().norm() - 0.5;
      EXPECT_LT(range, 60 + 5);
      EXPECT_GE(o.id, kFirstGhost);
    }
  }
  // 4000 are expected, with a standard deviation of 63; each is in about life / step lists.
  EXPECT_NEAR(double(ids.size()), 4 * kStep * kCycles, 250);
  EXPECT_NEAR(double(shown) / double(ids.size()), 0.7 / kStep + 0.5, 1.0);
}

TEST(FalsePositives, AreTheSameForTheSameSeedAndAfterAReset) {
  FalsePositives a(busy(), 5), b(busy(), 5), c(busy(), 6);
  bool differs = false;
  std::vector<ObjectList> first;
  for (int k = 0; k < 100; ++k) {
    ObjectList x, y, z;
    x.time_s = y.time_s = z.time_s = 0.1 * k;
    a.step(x);
    b.step(y);
    c.step(z);
    ASSERT_EQ(x.objects.size(), y.objects.size());
    for (size_t i = 0; i < x.objects.size(); ++i) {
      EXPECT_EQ(x.objects[i].box.centre_m, y.objects[i].box.centre_m);
    }
    differs = differs || x.objects.size() != z.objects.size();
    first.push_back(x);
  }
  EXPECT_TRUE(differs);
  a.reset();
  for (int k = 0; k < 100; ++k) {
    ObjectList x;
    x.time_s = 0.1 * k;
    a.step(x);
    EXPECT_EQ(x.objects.size(), first[size_t(k)].objects.size());
  }
}

TEST(FalsePositives, NoneWithoutARate) {
  FalsePositives maker;
  ObjectList list;
  for (int k = 0; k < 50; ++k) {
    list.time_s = k;
    maker.step(list);
  }
  EXPECT_TRUE(list.objects.empty());
}

}  // namespace
}  // namespace underbrush::perception
