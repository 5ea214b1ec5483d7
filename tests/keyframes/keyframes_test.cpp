// Tests of keyframes: near them a model answers as the sensor did there, and far from them nothing
// changes.
#include "underbrush/keyframes/keyframes.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "ball_scanner.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/keyframes/keyframe_images.hpp"

namespace underbrush::keyframes {
namespace {

using test::answered;
using test::fitted;
using test::kColumns;
using test::kDrive;
using test::kPlace;
using test::kRings;
using test::scanned;
using test::scored;

TEST(Keyframes, NearThemAModelAnswersAsTheSensorDid) {
  const BeamLog drive = scanned(kDrive, 0, 0.7);
  const elements::Model with = fitted(drive, 1), without = fitted(drive, 0);
  ASSERT_TRUE(with.keyframes);
  EXPECT_FALSE(without.keyframes);
  const BeamLog test = scanned({1.0, 3.2, 5.1}, 100, 0.7);
  const metrics::Summary a = scored(without, test), b = scored(with, test);
  EXPECT_LT(b.nll_per_beam, a.nll_per_beam - 0.003);
  EXPECT_LT(b.crps_m, a.crps_m);
}

TEST(Keyframes, AStandingSensorRepeatsItself) {
  const BeamLog log = scanned({0, 0, 0, 0, 0}, 0);
  const elements::Model with = fitted(log, 1), without = fitted(log, 0);
  EXPECT_EQ(with.keyframes->frames.size(), 5u);
  const BeamLog test = scanned({0, 0}, 100);
  const metrics::Summary a = scored(without, test), b = scored(with, test);
  // The model without them knows the noise of the sensor, which repeats its directions.
  EXPECT_LT(a.nll_per_beam, -1.8);
  EXPECT_LT(b.nll_per_beam, a.nll_per_beam - 0.03);
  EXPECT_LT(b.packet_error_m, 0.85 * a.packet_error_m);
  EXPECT_GT(b.f1, a.f1);
}

// The numbers of the scans that become keyframes of a sensor that stands.
std::vector<uint32_t> kept_scans(const BeamLog& log, size_t most_bytes) {
  MemorySource source(log);
  KeyframeOptions options;
  options.most_bytes = most_bytes;
  std::vector<uint32_t> out;
  for (const auto& [scan, frame] :
       make_keyframe_images(source, Vec3::Zero(), options).frame_of_scan) {
    EXPECT_EQ(frame, out.size());
    out.push_back(scan);
  }
  return out;
}

TEST(Keyframes, OfASensorThatStandsAreSpreadOverTime) {
  const BeamLog log = scanned(std::vector<double>(40), 0);
  const size_t bytes =
      kRings * kColumns * sizeof(elements::KeyframePixel) + kColumns * sizeof(Vec3f);
  for (const auto& [most, count, gap] :
       {std::tuple{size_t(1) << 28, 16, 4u}, {7 * bytes, 4, 16u}, {bytes, 2, 32u}}) {
    const std::vector<uint32_t> scans = kept_scans(log, most);
    ASSERT_EQ(scans.size(), size_t(count));
    for (size_t k = 1; k < scans.size(); ++k) EXPECT_LE(scans[k] - scans[k - 1], gap);
  }
}

TEST(Keyframes, AScanBesideTheImageIsNone) {
  BeamLog log = scanned({0, 0.1, 0.2}, 0);
  for (size_t i = 0; i < log.size(); ++i) {
    if (log.scan[i] == 1) log.direction[i] = Vec3f(0, 0, 1);
  }
  EXPECT_EQ(kept_scans(log, size_t(1) << 28), (std::vector<uint32_t>{0, 2}));
  EXPECT_EQ(fitted(log, 1).keyframes->frames.size(), 2u);
}

TEST(Keyframes, OfNearlyTheSameTimeMakeUpForPosesThatDrift) {
  std::vector<double> true_x, test_x{0.15, 0.45, 0.75};
  for (int k = 0; k < 10; ++k) true_x.push_back(0.1 * k);
  BeamLog log = scanned(true_x, 0), test = scanned(test_x, 100);
  for (BeamLog* l : {&log, &test}) {  // a tenth of the motion is in the poses
    for (Vec3& o : l->origin) o.x() -= 0.9 * (o.x() - kPlace.x());
  }
  const elements::Model all = fitted(log, 1), two = fitted(log, 1, 1);
  EXPECT_EQ(all.keyframes->frames.size(), 10u);
  EXPECT_EQ(two.keyframes->frames.size(), 2u);
  const metrics::Summary a = scored(all, test), b = scored(two, test);
  EXPECT_LT(a.nll_per_beam, b.nll_per_beam - 0.05);
  EXPECT_LT(a.packet_error_m, b.packet_error_m);
}

TEST(Keyframes, OneScanLearnsFromItsNeighbours) {
  const BeamLog log = scanned({0}, 0);
  const elements::Model with = fitted(log, 1), without = fitted(log, 0);
  ASSERT_TRUE(with.keyframes);
  const BeamLog test = scanned({0}, 100);
  const metrics::Summary a = scored(without, test), b = scored(with, test);
  EXPECT_LT(b.nll_per_beam, a.nll_per_beam - 0.3);
  EXPECT_LT(b.packet_error_m, 0.65 * a.packet_error_m);
  EXPECT_GT(b.f1, a.f1 + 0.03);
}

// In learning a beam of two scans sees the other one alone, and in use it sees both.
TEST(Keyframes, OfTwoScansTheSecondNearestHasNoWeight) {
  const elements::Model with = fitted(scanned({0, 0.7}, 0), 1),
                        without = fitted(scanned({0, 0.7}, 0), 0);
  ASSERT_TRUE(with.keyframes);
  for (const elements::KeyframeWeights& t : with.keyframes->weights) {
    for (size_t r = elements::Keyframes::kPixelsOfFrame; r < t.pixel.size(); ++r) {
      EXPECT_EQ(t.pixel[r], 0);
    }
  }
  const BeamLog test = scanned({0.35}, 100);
  EXPECT_LT(scored(with, test).nll_per_beam, scored(without, test).nll_per_beam);
}

// Between every second column beams are to be as far from the pixels of other rows as in use.
TEST(Keyframes, HalfOfTheColumnsKeepTheRows) {
  BeamLog log = scanned({0}, 0);
  for (const bool has_channels : {true, false}) {
    if (!has_channels) std::fill(log.ring.begin(), log.ring.end(), uint16_t(0));
    MemorySource source(log);
    const KeyframeOptions options;
    const elements::Keyframes whole = make_keyframe_images(source, Vec3::Zero(), options).keyframes;
    const elements::Keyframes half =
        make_half_images(source, whole, Vec3::Zero(), options).keyframes;
    EXPECT_EQ(half.elevation, whole.elevation);
    EXPECT_EQ(half.channel, whole.channel);
    EXPECT_EQ(half.channel.empty(), !has_channels);
    EXPECT_EQ(half.columns, whole.columns / 2);
    ASSERT_EQ(half.frames.size(), 1u);
    EXPECT_EQ(half.frames[0].pixels.size(), half.rows() * half.columns);
  }
}

TEST(Keyframes, ANegativeSpacingIsRefused) {
  MemorySource source(scanned({0}, 0));
  fit::FitOptions options;
  options.keyframes.spacing_m = -1;
  EXPECT_THROW(fit::fit(source, options), std::invalid_argument);
}

// What lies between the rings of a log is unknown to its keyframes.
TEST(Keyframes, OtherChannelsAreNotAnswered) {
  elements::Model with = fitted(scanned(kDrive, 0, 0.7), 1), without = with;
  without.keyframes.reset();
  BeamLog test = scanned({3}, 200);
  EXPECT_NE(answered(with, test).range_m, answered(without, test).range_m);
  for (uint16_t& ring : test.ring) ring = uint16_t(ring + kRings);
  EXPECT_EQ(answered(with, test).range_m, answered(without, test).range_m);
}

// Neighbours on one surface choose and err alike where matter is drawn once.
TEST(Keyframes, RingsAreSmoothWhereMatterIsDrawnOnce) {
  const elements::Model model = fitted(scanned({0, 0, 0, 0, 0}, 0), 1);
  const BeamLog test = scanned({0, 0}, 100);
  const auto roughness = [&](trace::Draws draws) {
    BeamLog drawn = test;
    simulate::simulate(trace::World(model, trace::Isa::kBest, draws), simulate::Options(), 0,
                       drawn);
    MemorySource real(test), simulated(drawn);
    const metrics::Score score = metrics::score(real, simulated, {});
    return score.roughness_m / score.real_roughness_m;
  };
  const double once = roughness(trace::Draws::kOnce), anew = roughness(trace::Draws::kAnew);
  EXPECT_NEAR(once, 1, 0.1);
  EXPECT_LT(once, 0.92 * anew);
}

// The median answers without a draw from the same mixture.
TEST(Keyframes, TheMedianOfWhatTheyRecallIsNearest) {
  const elements::Model with = fitted(scanned({0, 0, 0, 0, 0}, 0), 1), without = [&] {
    elements::Model m = with;
    m.keyframes.reset();
    return m;
  }();
  const BeamLog test = scanned({0, 0}, 100);
  const auto median = [&](const elements::Model& model) {
    BeamLog beams = test;
    simulate::Options options;
    options.draw = simulate::RangeDraw::kMedian;
    simulate::simulate(trace::World(model), options, 0, beams);
    MemorySource real(test), simulated(beams);
    return metrics::score(real, simulated, {}).all;
  };
  EXPECT_LT(median(with).packet_error_m, 0.8 * median(without).packet_error_m);
  EXPECT_LT(median(with).packet_error_m, 0.9 * scored(with, test).packet_error_m);
  EXPECT_GT(median(with).f1, scored(with, test).f1);
}

TEST(Keyframes, ALogTooShortToTrustThemHasNone) {
  const BeamLog whole = scanned({0}, 0);
  BeamLog few = whole;
  few.resize(900);
  EXPECT_FALSE(fitted(few, 1).keyframes);
  EXPECT_TRUE(fitted(whole, 1).keyframes);
}

TEST(Keyframes, FarFromThemNothingChanges) {
  const BeamLog drive = scanned(kDrive, 0, 0.7);
  elements::Model with = fitted(drive, 1), without = with;
  without.keyframes.reset();
  const BeamLog away = scanned({25, 31}, 100), near = scanned({3}, 200);
  EXPECT_EQ(answered(with, away).range_m, answered(without, away).range_m);
  EXPECT_NE(answered(with, near).range_m, answered(without, near).range_m);
  BeamLog other = near;
  other.info.sensor = "another";
  EXPECT_EQ(answered(with, other).range_m, answered(without, other).range_m);
  EXPECT_EQ(answered(with, near, true).range_m, answered(without, near, true).range_m);
}

TEST(Keyframes, TheSameBitsForAnyThreadsAndChunks) {
  const BeamLog drive = scanned(kDrive, 0, 0.7), test = scanned({2.3}, 100);
  std::vector<std::vector<float>> answers;
  for (const size_t chunk : {size_t(1) << 20, size_t(7001)}) {
    for (const int threads : {1, 2}) {
      set_threads(threads);
      fit::FitOptions options;
      options.keyframes.spacing_m = 1;
      MemorySource source(drive, chunk);
      answers.push_back(answered(fit::fit(source, options).model, test).range_m);
    }
  }
  set_threads(0);
  for (const auto& a : answers) EXPECT_EQ(a, answers[0]);
}

TEST(Keyframes, SurviveAModelFolder) {
  const BeamLog drive = scanned({0, 1, 2}, 0, 0.7), test = scanned({1.2}, 100);
  const elements::Model model = fitted(drive, 1);
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "keyframes_model";
  elements::write_model(folder, model);
  const elements::Model read = elements::read_model(folder);
  ASSERT_TRUE(read.keyframes);
  const BeamLog a = answered(model, test), b = answered(read, test);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.intensity, b.intensity);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace underbrush::keyframes
