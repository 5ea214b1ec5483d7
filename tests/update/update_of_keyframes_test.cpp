// Tests of what an update does to the keyframes of a model.
#include <gtest/gtest.h>

#include "ball_scanner.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/keyframes/changed_pixels.hpp"
#include "underbrush/keyframes/keyframe_images.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/update/update.hpp"
#include "update_site.hpp"

namespace underbrush::update {
namespace {

using test::kDrive;
using test::kPlace;
using test::scanned;
using test::scored;

bool is_at_the_car(const Vec3& point) {
  const Vec3 at = (point - kCar).cwiseAbs();
  return at.x() < 2 && at.y() < 1 && at.z() < 0.75;
}

size_t remembered_of_the_car(const elements::Model& model) {
  size_t n = 0;
  for (const elements::Keyframe& f : model.keyframes->frames) {
    for (const elements::KeyframePixel& p : f.pixels) {
      n += p.is_hit() && is_at_the_car(model.origin + f.origin + model.keyframes->point(p));
    }
  }
  return n;
}

/// The returns at the car that a model gives to some beams.
size_t returns_of_the_car(const elements::Model& model, BeamLog beams) {
  simulate::simulate(trace::World(model), simulate::Options(), 0, beams);
  size_t n = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    n += beams.is_hit(i) && is_at_the_car(beams.end_point(i));
  }
  return n;
}

TEST(UpdateOfKeyframes, ForgetsWhatHasGoneAndKeepsTheRest) {
  const BeamLog before = drive(true, 1, 60'000), after = drive(false, 2, 60'000),
                test = drive(false, 3, 60'000);
  const fit::FitResult first = fitted(before);
  ASSERT_TRUE(first.model.keyframes);
  const UpdateResult grown = updated(first, {&before}, after, kAtOnce);
  ASSERT_TRUE(grown.model.keyframes);
  const keyframes::KeyframeChanges& changes = grown.report.keyframes;
  EXPECT_EQ(changes.kept, first.model.keyframes->frames.size());
  EXPECT_EQ(changes.added, grown.model.keyframes->frames.size() - changes.kept);
  EXPECT_GT(changes.added, 5u);
  const size_t was = remembered_of_the_car(first.model);
  EXPECT_GT(was, 1000u);
  EXPECT_LT(remembered_of_the_car(grown.model), was / 10);
  EXPECT_LT(changes.forgotten_pixels, 5 * was / 4);
  EXPECT_LT(returns_of_the_car(grown.model, test), returns_of_the_car(first.model, test) / 20);
  BeamLog of_another = after;  // Neither log names its sensor, and only this one has channels.
  for (size_t i = 0; i < of_another.size(); ++i) of_another.ring[i] = uint16_t(i % 16);
  EXPECT_THROW(updated(first, {&before}, of_another, kAtOnce), DataError);
}

/// The pixels of a log's scans, one after another, of beams that pass where the car is when it is
/// there: how many of them the first keyframes know.
size_t known_through_the_car(const elements::Model& model, const BeamLog& log) {
  const elements::Keyframes& k = *model.keyframes;
  const elements::KeyframeGrid grid(k);
  size_t known = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    const Vec3 d = log.direction[i].cast<double>();
    const double along = (kCar.y() - log.origin[i].y()) / d.y();
    const Vec3 at = (log.origin[i] + along * d - kCar).cwiseAbs();
    if (!(along > 0) || at.x() > 1.5 || at.z() > 0.5) continue;
    if (log.is_hit(i) && double(log.range_m[i]) < along) continue;
    const elements::Keyframe& f = k.frames[log.scan[i]];
    const auto place = grid.place(f.sensor_from_world * d);
    if (!(place.row >= 0)) continue;
    known += !f.pixels[size_t(place.row) * k.columns + size_t(place.column)].is_unknown();
  }
  return known;
}

// Where a car has come, the beams that passed there, with or without a return, are forgotten.
TEST(UpdateOfKeyframes, ForgetsWhatIsBehindWhatHasCome) {
  const BeamLog before = drive(false, 1, 60'000), after = drive(true, 2, 60'000);
  const fit::FitResult first = fitted(before);
  const UpdateResult grown = updated(first, {&before}, after, kAtOnce);
  ASSERT_EQ(grown.report.keyframes.kept, 20u);
  const size_t was = known_through_the_car(first.model, before);
  EXPECT_GT(was, 500u);
  EXPECT_LT(known_through_the_car(grown.model, before), was / 4) << was;
}

// A pixel without a return is forgotten if its direction leads to what has changed.
TEST(UpdateOfKeyframes, ForgetsMissesTowardsWhatHasCome) {
  elements::Keyframes k;
  for (int row = -10; row <= 10; ++row) k.elevation.push_back(0.02 * row);
  k.columns = 360;
  k.unit_m = 0.01;
  elements::Keyframe frame;
  frame.origin = Vec3(3, -2, 1);
  frame.sensor_from_world = Eigen::AngleAxisd(0.4, Vec3(0.1, 0.2, 1).normalized());
  elements::KeyframePixel miss;
  miss.x = elements::KeyframePixel::kNoReturn;
  frame.pixels.assign(k.pixels(), miss);
  frame.column_origin.assign(k.columns, Vec3f::Zero());
  k.frames = {frame};
  elements::Model changed;
  changed.origin = Vec3(100, 50, 0);
  changed.tau = 3;
  changed.max_range_m = 40;
  const Vec3 way(8, 14, 0.5);
  test::add_bush((frame.origin + way).cast<float>(), {0.04, 0.04, 0.04}, 1, changed);
  const size_t forgotten = keyframes::forget_changed(k, changed);
  EXPECT_GT(forgotten, 5u);
  EXPECT_LT(forgotten, 40u);  // a disc of 0.6 m at 16 m is four rows and columns wide
  const auto place = elements::KeyframeGrid(k).place(frame.sensor_from_world * way);
  const size_t pixel = size_t(place.row) * k.columns + size_t(place.column);
  EXPECT_TRUE(k.frames[0].pixels[pixel].is_unknown());
  changed.max_range_m = 10;
  k.frames = {frame};
  EXPECT_EQ(keyframes::forget_changed(k, changed), 0u);
}

TEST(UpdateOfKeyframes, OfAnUnchangedWorldAllStay) {
  const BeamLog a = drive(true, 1, 60'000), few = drive(true, 2, 3'000);
  const fit::FitResult first = fitted(a);
  const UpdateResult grown = updated(first, {&a}, few, {});
  ASSERT_TRUE(grown.model.keyframes);
  EXPECT_EQ(grown.report.keyframes.kept, first.model.keyframes->frames.size());
  EXPECT_EQ(grown.report.keyframes.forgotten_pixels, 0u);
  for (size_t f = 0; f < grown.report.keyframes.kept; ++f) {
    const elements::Keyframe &was = first.model.keyframes->frames[f],
                             &now = grown.model.keyframes->frames[f];
    EXPECT_EQ(now.origin, was.origin);
    for (size_t p = 0; p < was.pixels.size(); ++p) {
      ASSERT_EQ(now.pixels[p].is_hit(), was.pixels[p].is_hit());
      if (!was.pixels[p].is_hit()) continue;
      const Vec3 moved =
          grown.model.keyframes->point(now.pixels[p]) - first.model.keyframes->point(was.pixels[p]);
      ASSERT_LT(moved.norm(), 0.01);
    }
  }
}

TEST(UpdateOfKeyframes, AModelWithoutAnyStaysSo) {
  const BeamLog a = drive(true, 1, 20'000), b = drive(true, 2, 20'000);
  fit::FitOptions without = small_tiles();
  without.keyframes.spacing_m = 0;
  EXPECT_FALSE(updated(fitted(a, without), {&a}, b, {}, 1 << 20, without).model.keyframes);
}

// A few new scans do not make the places worse that earlier ones saw from near by.
TEST(UpdateOfKeyframes, RemembersWhatEarlierScansSaw) {
  const BeamLog a = scanned(kDrive, 0, 0.7), b = scanned({15, 15.7}, 20, 0.7);
  const BeamLog near_a = scanned({1.0, 3.2, 5.1}, 100, 0.7), near_b = scanned({15.3}, 110, 0.7);
  elements::Model model = test::fitted(joined(a, b), 0);
  const metrics::Summary a_without = scored(model, near_a), b_without = scored(model, near_b);
  keyframes::KeyframeOptions options;
  options.spacing_m = 0.5;
  MemorySource first(a), second(b);
  keyframes::learn_keyframes(model, first, options);
  const metrics::Summary a_before = scored(model, near_a);
  EXPECT_LT(a_before.nll_per_beam, a_without.nll_per_beam - 0.003);
  const keyframes::KeyframeChanges changes =
      keyframes::update_keyframes(model, second, options, elements::Model());
  EXPECT_EQ(changes.kept, kDrive.size());
  EXPECT_EQ(changes.added, 2u);
  EXPECT_EQ(changes.forgotten_pixels, 0u);
  EXPECT_LT(scored(model, near_a).nll_per_beam, a_without.nll_per_beam - 0.003);
  EXPECT_LT(scored(model, near_b).nll_per_beam, b_without.nll_per_beam - 0.003);
}

// Returns beyond the reach of earlier pixels make the units of all coarser.
TEST(UpdateOfKeyframes, FartherReturnsFit) {
  const BeamLog a = scanned({0, 0.7}, 0);
  BeamLog b = scanned({1.4}, 5);
  for (size_t i = 0; i < b.size(); ++i) {
    if (b.is_hit(i)) b.range_m[i] *= 4;
    b.intensity[i] *= 3;
  }
  MemorySource before(a), after(b);
  const keyframes::KeyframeOptions options;
  const elements::Keyframes known =
      keyframes::make_keyframe_images(before, kPlace, options).keyframes;
  const keyframes::KeyframeImages both =
      keyframes::add_keyframe_images(after, known, kPlace, options);
  const elements::Keyframes& now = both.keyframes;
  ASSERT_EQ(now.frames.size(), 3u);
  EXPECT_EQ(both.frame_of_scan.at(5), 2u);
  EXPECT_EQ(now.elevation, known.elevation);
  EXPECT_GT(now.unit_m, 2 * known.unit_m);
  EXPECT_NEAR(now.intensity_unit, 3 * known.intensity_unit, 0.1 * known.intensity_unit);
  double farthest = 0;
  for (size_t f = 0; f < 3; ++f) {
    for (size_t p = 0; p < now.pixels(); ++p) {
      const elements::KeyframePixel& pixel = now.frames[f].pixels[p];
      if (f == 2) {
        if (pixel.is_hit()) farthest = std::max(farthest, now.point(pixel).norm());
        continue;
      }
      const elements::KeyframePixel& was = known.frames[f].pixels[p];
      ASSERT_EQ(pixel.is_hit(), was.is_hit());
      if (!pixel.is_hit()) continue;
      ASSERT_LT((now.point(pixel) - known.point(was)).norm(), 2 * now.unit_m);
      ASSERT_NEAR(pixel.intensity * now.intensity_unit, was.intensity * known.intensity_unit,
                  now.intensity_unit);
    }
  }
  EXPECT_GT(farthest, 100);
}

}  // namespace
}  // namespace underbrush::update
