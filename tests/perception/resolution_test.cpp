#include "underbrush/perception/resolution.hpp"

#include <gtest/gtest.h>

#include "clouds.hpp"
#include "underbrush/perception/tracking_model.hpp"

namespace underbrush::perception {
namespace {

TruthObject person(uint64_t id, double y) {
  return {id, ObjectClass::kPedestrian, {{20, y, 0.9}, 0, {0.5, 0.5, 1.8}}};
}

// Two people approach each other to a gap, and part again.
TEST(Resolution, TwoBecomeOneBelowTheGapAndSplitWithHysteresis) {
  TrackingOptions options;
  options.resolution.enabled = true;
  options.resolution.least_gap_m = 0.4;
  options.resolution.gap_rad = 0;
  TrackingModel model(options);
  ObjectList list;
  std::vector<double> merged_gaps, closing, parting;
  for (int k = 0; k <= 80; ++k) {
    const double gap = std::abs(k - 40) * 0.05 + 0.1, t = 0.1 * k;
    const std::vector<TruthObject> objects{person(1, 0), person(2, 0.5 + gap)};
    MergedCloud cloud = test::empty_cloud(t);
    for (const auto& o : objects) test::add_box(cloud, o.box, 0.05);
    model.step(cloud, {t, objects}, list);
    const bool is_merged = !model.merged().empty();
    if (is_merged) (k <= 40 ? closing : parting).push_back(gap);
    EXPECT_EQ(is_merged, model.segments().points(0).empty() || model.segments().points(1).empty());
  }
  ASSERT_FALSE(closing.empty());
  EXPECT_NEAR(closing.front(), 0.4, 0.051) << "they merge below the gap";
  EXPECT_NEAR(parting.back(), 0.6, 0.051) << "and split above 1.5 times the gap";
  EXPECT_EQ(list.objects.size(), 2u);
}

TEST(Resolution, ThePointsGoToTheListedObject) {
  Resolution resolution({.enabled = true, .least_gap_m = 0.5});
  Segments segments;
  segments.of_point = {0, 0, 0, 1};
  const std::vector<Vec3> points{{5, 0, 1}, {5, 0.1, 1}, {5, 0.2, 1}, {5, 0.4, 1}};
  segments.gather(points, 2);
  const std::vector<uint64_t> ids{4, 3};
  ASSERT_TRUE(resolution.merge(ids, std::vector<uint8_t>{0, 1}, Vec3::Zero(), segments));
  EXPECT_EQ(segments.of_point, (std::vector<uint32_t>{1, 1, 1, 1}));
  EXPECT_EQ(resolution.merged(), (std::vector<MergedPair>{{3, 4}}));
}

TEST(Resolution, GrowsWithTheRange) {
  Resolution resolution({.enabled = true, .least_gap_m = 0.1, .gap_rad = 0.01});
  for (const double range : {10.0, 90.0}) {
    Segments segments;
    segments.of_point = {0, 1};
    segments.gather(std::vector<Vec3>{{range, 0, 1}, {range, 0.5, 1}}, 2);
    EXPECT_EQ(resolution.merge(std::vector<uint64_t>{1, 2}, std::vector<uint8_t>{0, 0},
                               Vec3::Zero(), segments),
              range > 50);
    resolution.reset();
  }
}

}  // namespace
}  // namespace underbrush::perception
