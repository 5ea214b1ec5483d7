#include "underbrush/perception/list_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::perception {
namespace {

TrackedObject car(uint64_t id, double x, double y, double length = 4) {
  TrackedObject o;
  o.id = id;
  o.label = ObjectClass::kCar;
  o.box = {{x, y, 1}, 0, {length, 2, 1.5}};
  return o;
}

std::vector<ObjectList> lists_of(const std::vector<std::vector<TrackedObject>>& cycles) {
  std::vector<ObjectList> lists;
  for (size_t k = 0; k < cycles.size(); ++k) {
    ObjectList list;
    list.time_s = 0.1 * double(k);
    list.objects = cycles[k];
    lists.push_back(list);
  }
  return lists;
}

TEST(ScoreLists, AListAgainstItselfIsPerfect) {
  const auto lists = lists_of({{car(1, 10, 0), car(2, 20, 5)}, {car(1, 11, 0)}, {}});
  const ListScore score = score_lists(lists, lists);
  EXPECT_EQ(score.cycles, 3u);
  EXPECT_EQ(score.objects, 3u);
  EXPECT_EQ(score.found, 3u);
  EXPECT_EQ(score.unmatched + score.switches, 0u);
  EXPECT_EQ(score.position_rms_m, 0);
  EXPECT_EQ(score.ospa_m, 0);
}

TEST(ScoreLists, CountsByRangeSwitchesAndFalseObjects) {
  const auto truth = lists_of({{car(1, 10, 0), car(2, 25, 5)}, {car(1, 11, 0), car(2, 26, 5)}});
  const auto list = lists_of({{car(7, 10.3, 0.4), car(8, 60, 0)}, {car(9, 11, 0)}});
  const ListScore score = score_lists(list, truth);
  EXPECT_EQ(score.found, 2u);
  EXPECT_EQ(score.unmatched, 1u);
  EXPECT_EQ(score.switches, 1u);
  EXPECT_NEAR(score.position_mean_m, 0.25, 1e-12);
  EXPECT_NEAR(score.position_rms_m, 0.5 / std::sqrt(2.0), 1e-12);
  ASSERT_EQ(score.by_range.size(), 3u);
  EXPECT_EQ(score.by_range[1].objects, 2u);
  EXPECT_EQ(score.by_range[1].found, 2u);
  EXPECT_EQ(score.by_range[2].found, 0u);
  ASSERT_EQ(score.followed.size(), 2u);
  EXPECT_TRUE(score.followed[0].moments[0].found);
  EXPECT_FALSE(score.followed[1].moments[0].found);
  // Cycle 1: a pair 0.5 m apart and one at the cut-off; cycle 2: a pair and a missing object.
  EXPECT_NEAR(score.ospa_m, ((0.5 + 10) / 2 + 10 / 2.0) / 2, 1e-9);
  ListScoreOptions open;
  open.ignore_unmatched = true;
  EXPECT_EQ(score_lists(list, truth, open).unmatched, 0u);
}

TEST(ScoreLists, OspaIsSymmetric) {
  const auto a = lists_of({{car(1, 10, 0), car(2, 25, 5)}, {car(1, 11, 0)}});
  const auto b = lists_of({{car(1, 12, 0)}, {car(1, 11, 3), car(2, 30, 5), car(3, 9, 1)}});
  EXPECT_NEAR(score_lists(a, b).ospa_m, score_lists(b, a).ospa_m, 1e-12);
}

TEST(Hota, OfAListAgainstItselfIsOne) {
  const auto lists = lists_of({{car(1, 10, 0), car(2, 20, 5)}, {car(1, 11, 0)}, {}});
  const Hota h = score_lists(lists, lists).hota;
  EXPECT_NEAR(h.hota, 1, 1e-12);
  EXPECT_NEAR(h.detection, 1, 1e-12);
  EXPECT_NEAR(h.association, 1, 1e-12);
}

// A number that changes halfway: each pair is together in one cycle of the two that have either.
TEST(Hota, OfAChangedNumberByHand) {
  const auto truth = lists_of({{car(1, 10, 0)}, {car(1, 11, 0)}});
  const Hota h = score_lists(lists_of({{car(7, 10, 0)}, {car(9, 11, 0)}}), truth).hota;
  EXPECT_NEAR(h.detection, 1, 1e-12);
  EXPECT_NEAR(h.association, 0.5, 1e-12);
  EXPECT_NEAR(h.hota, std::sqrt(0.5), 1e-12);
}

// Half a metre of the two at which nothing is similar: 15 of the 19 thresholds take the pair.
TEST(Hota, OfADistanceByHand) {
  const auto truth = lists_of({{car(1, 10, 0)}});
  EXPECT_NEAR(score_lists(lists_of({{car(7, 10.5, 0)}}), truth).hota.hota, 15 / 19.0, 1e-12);
  EXPECT_EQ(score_lists(lists_of({{car(7, 12.5, 0)}}), truth).hota.hota, 0);
}

TEST(Hota, MissingAndFalseObjectsCostDetection) {
  const auto truth = lists_of({{car(1, 10, 0), car(2, 30, 0)}, {car(1, 11, 0)}});
  const auto list = lists_of({{car(5, 10, 0), car(6, 60, 0)}, {car(5, 11, 0)}});
  EXPECT_NEAR(score_lists(list, truth).hota.detection, 2 / 4.0, 1e-12);
  EXPECT_NEAR(score_lists(list, truth).hota.association, 1, 1e-12);
  ListScoreOptions open;
  open.ignore_unmatched = true;
  EXPECT_NEAR(score_lists(list, truth, open).hota.detection, 2 / 3.0, 1e-12);
  EXPECT_NEAR(score_lists(list, truth).hota.hota, score_lists(truth, list).hota.hota, 1e-12);
}

// Two objects that cross: the pairs follow the numbers that are together most of the time.
TEST(Hota, PairsFollowTheNumbers) {
  std::vector<std::vector<TrackedObject>> truth, list;
  for (int k = 0; k < 9; ++k) {
    const double y = 0.5 * (k - 4);
    truth.push_back({car(1, 10, y), car(2, 10, -y)});
    list.push_back({car(8, 10, -y), car(7, 10, y)});
  }
  EXPECT_NEAR(score_lists(lists_of(list), lists_of(truth)).hota.association, 1, 1e-12);
}

// [rosenberger20] §4.2, by hand.
TEST(CompareLists, IsThePapersEquation) {
  const auto truth = lists_of({{car(1, 10, 2, 4)}, {car(1, 12, 2, 4)}});
  const auto real = lists_of({{car(5, 10.3, 2, 3)}, {car(5, 12.4, 2, 3)}});
  const auto sim = lists_of({{car(6, 10.3, 2, 3.2)}, {car(6, 12.4, 2, 3)}});
  const auto rows = compare_lists(sim, real, truth);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].simulated_real.cycles, 2u);
  EXPECT_NEAR(rows[0].simulated_real.normalised[0], 0, 1e-12);
  EXPECT_NEAR(rows[0].simulated_real.normalised[3], std::sqrt(0.04 / 2) / 4, 1e-12);
  EXPECT_NEAR(rows[0].real_truth.normalised[0], std::sqrt((0.09 + 0.16) / 2) / 10, 1e-12);
  EXPECT_NEAR(rows[0].real_truth.rmse_m[3], 1, 1e-12);
  EXPECT_NEAR(rows[0].simulated_truth.normalised[3], std::sqrt((0.64 + 1) / 2) / 4, 1e-12);
}

TEST(CompareLists, PositionsAreSeenFromTheFirstPlaceOfTheVehicle) {
  auto truth = lists_of({{car(1, 110, 52)}, {car(1, 112, 52)}});
  truth[0].world_from_vehicle.translation = {100, 50, 0};
  const auto list = lists_of({{car(5, 111, 52)}, {car(5, 113, 52)}});
  const auto rows = compare_lists(list, list, truth);
  EXPECT_NEAR(rows[0].simulated_truth.normalised[0], 1.0 / 10, 1e-12);
}

}  // namespace
}  // namespace underbrush::perception
