// Tests of keyframes: near them a model answers as the sensor did there, far from them nothing
// changes, and what they recall from a place beside them is where the points are seen from there.
#include "underbrush/fit/keyframes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/fit.hpp"
#include "underbrush/fit/keyframe_images.hpp"
#include "underbrush/metrics/score.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/trace/recollection.hpp"

namespace underbrush::fit {
namespace {

constexpr uint16_t kRings = 24;
constexpr int kColumns = 500;
constexpr double kNoiseM = 0.01;
const Vec3 kPlace(411.3, -250, 17);  // where the x axis begins, m, world

double uniform(size_t a, uint32_t b) {
  return uniform_from_bits(random_bits(a, b, Purpose::kPlace));
}

struct Ball {
  Vec3 middle;
  double radius;
};

// Balls of 10 to 40 cm on both sides of the x axis, as crowns of many leaves.
std::vector<Ball> balls() {
  std::vector<Ball> out;
  for (uint32_t k = 0; k < 900; ++k) {
    const double side = k % 2 ? 1 : -1;
    out.push_back({kPlace + Vec3(50 * uniform(k, 1) - 20, side * (4 + 14 * uniform(k, 2)),
                                 4 * uniform(k, 5) - 1.5),
                   0.1 + 0.3 * uniform(k, 3)});
  }
  return out;
}

// The range to the ground, 2 m below the x axis, or to the nearest ball, m.
double true_range(const Ray& ray, const std::vector<Ball>& all) {
  const double down = ray.direction.z();
  double nearest = down < 0 ? (kPlace.z() - 2 - ray.origin.z()) / down : HUGE_VAL;
  for (const Ball& ball : all) {
    const Vec3 to = ball.middle - ray.origin;
    const double along = to.dot(ray.direction);
    const double root = ball.radius * ball.radius - to.squaredNorm() + along * along;
    if (root > 0 && along > 0) nearest = std::min(nearest, along - std::sqrt(root));
  }
  return nearest;
}

// Scans from places on the x axis. The sensor moves by `drift_m` in a scan.
BeamLog scanned(const std::vector<double>& at, uint32_t first_scan, double drift_m = 0) {
  const std::vector<Ball> all = balls();
  BeamLog log;
  log.info.sensor = "ball-scanner";
  log.info.has_misses = true;
  log.info.max_range_m = 50;
  log.resize(at.size() * kColumns * kRings);
  size_t i = 0;
  for (size_t s = 0; s < at.size(); ++s) {
    const uint32_t scan = first_scan + uint32_t(s);
    for (int k = 0; k < kColumns; ++k) {
      for (uint16_t ring = 0; ring < kRings; ++ring, ++i) {
        const double azimuth = 2 * M_PI * (k + uniform(scan, 9)) / kColumns;
        const double elevation = (6 - ring) * M_PI / 180;
        log.origin[i] = kPlace + Vec3(at[s] + drift_m * (double(k) / kColumns - 0.5), 0, 0);
        log.direction[i] =
            Vec3f(float(std::cos(elevation) * std::cos(azimuth)),
                  float(std::cos(elevation) * std::sin(azimuth)), float(std::sin(elevation)));
        const double range = true_range(log.ray(i), all) +
                             kNoiseM * normal(mix64(scan), uint32_t(i), Purpose::kNoise);
        log.range_m[i] = range < 50 ? float(range) : kMiss;
        log.intensity[i] = range < 50 ? float(10 + uniform(size_t(azimuth * 40), 4)) : 0;
        log.ring[i] = ring;
        log.scan[i] = scan;
        log.time_s[i] = scan * 0.1;
      }
    }
  }
  return log;
}

elements::Model fitted(const BeamLog& log, double spacing_m, size_t most_bytes = size_t(1) << 28) {
  FitOptions options;
  options.fitter = "hierarchical";
  MemorySource source(log);
  elements::Model model = fit(source, options).model;
  KeyframeOptions keyframes;
  keyframes.spacing_m = spacing_m;
  keyframes.most_bytes = most_bytes;
  learn_keyframes(model, source, keyframes);
  return model;
}

BeamLog answered(const elements::Model& model, BeamLog beams, bool element_ids = false) {
  const trace::World world(model);
  simulate::Options options;
  options.element_ids = element_ids;
  simulate::simulate(world, options, 0, beams);
  return beams;
}

metrics::Summary scored(const elements::Model& model, const BeamLog& real) {
  const BeamLog simulated = answered(model, real);
  const trace::World world(model);
  metrics::ScoreOptions options;
  options.world = &world;
  MemorySource a(real), b(simulated);
  return metrics::score(a, b, options).all;
}

const std::vector<double> kDrive{0, 0.7, 1.4, 2.1, 2.8, 3.5, 4.2, 4.9, 5.6, 6.3};

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
  EXPECT_LT(b.nll_per_beam, a.nll_per_beam - 0.07);
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

TEST(Keyframes, ANegativeSpacingIsRefused) {
  MemorySource source(scanned({0}, 0));
  FitOptions options;
  options.keyframes.spacing_m = -1;
  EXPECT_THROW(fit(source, options), std::invalid_argument);
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
  EXPECT_LT(once, 1.3);
  EXPECT_LT(once, 0.85 * anew);
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
      FitOptions options;
      options.keyframes.spacing_m = 1;
      MemorySource source(drive, chunk);
      answers.push_back(answered(fit(source, options).model, test).range_m);
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

// What is seen from beside a keyframe lies where it is: most beams' nearest pixel has the true
// range, but for those at the rims of balls.
TEST(Recollection, SeesPointsFromBesideTheKeyframe) {
  const BeamLog drive = scanned({0}, 0, 0.7);
  const elements::Model model = fitted(drive, 1);
  const trace::Recollection memory(model);
  for (const double aside : {0.0, 0.3, 1.0}) {
    const BeamLog test = scanned({aside}, 100);
    const std::vector<uint32_t> all{0};
    size_t seen = 0, right = 0;
    for (size_t i = 0; i < test.size(); ++i) {
      if (!test.is_hit(i) || test.range_m[i] > 15) continue;
      const Ray ray = test.ray(i);
      const trace::Recollection::Asked asked{ray, memory.near(ray.origin, all), 0};
      const trace::Recalled r = memory.recall({&asked, 1})[0];
      if (r.count == 0 || r.rank[0] != 0) continue;
      ++seen;
      // Half a pixel of elevation moves the place where a beam meets the ground.
      const double slack = 0.05 + 0.01 * test.range_m[i] * test.range_m[i] / 2;
      right += std::abs(r.range_m[0] - double(test.range_m[i])) < slack;
    }
    EXPECT_GT(double(seen), 0.5 * double(test.size()) * 0.5);
    EXPECT_GT(double(right), (aside == 0 ? 0.93 : aside < 1 ? 0.85 : 0.75) * double(seen)) << aside;
  }
}

struct Looked {
  elements::Model model;
  std::vector<Ray> rays;
  std::vector<uint16_t> rings;
};

// A model with keyframes, and rays near them and far from them.
Looked looked() {
  Looked out{fitted(scanned(kDrive, 0, 0.7), 1), {}, {}};
  const BeamLog test = scanned({1.0, 3.3, 9.5, 25}, 100, 0.7);
  out.rings = test.ring;
  for (size_t i = 0; i < test.size(); ++i) out.rays.push_back(test.ray(i));
  return out;
}

TEST(Recollection, WhatABeamSeesDoesNotDependOnTheOthers) {
  const Looked of = looked();
  const trace::Recollection memory(of.model);
  const std::vector<trace::Recollection::Asked> asked = memory.asked(of.rays, of.rings);
  const std::vector<trace::Recalled> all = memory.recall(asked);
  size_t seen = 0;
  for (size_t i = 0; i < asked.size(); i += 7) {
    const trace::Recalled alone = memory.recall({&asked[i], 1})[0];
    ASSERT_EQ(alone.count, all[i].count);
    EXPECT_EQ(alone.situation, all[i].situation);
    for (size_t k = 0; k < alone.count; ++k) {
      EXPECT_EQ(alone.range_m[k], all[i].range_m[k]);
      EXPECT_EQ(alone.rank[k], all[i].rank[k]);
    }
    seen += alone.count > 0;
  }
  EXPECT_GT(seen, asked.size() / 7 / 3);
}

// A simulation draws before it looks. What it then draws is what it would have drawn after a look.
TEST(Recollection, ADrawBeforeTheLookChangesNothing) {
  const Looked of = looked();
  const trace::Recollection memory(of.model);
  std::vector<trace::Recollection::Asked> asked = memory.asked(of.rays, of.rings);
  const std::vector<trace::Recalled> all = memory.recall(asked);
  for (size_t i = 0; i < asked.size(); ++i) asked[i].u = uniform(i, 11);
  const std::vector<trace::Recalled> drawn_first = memory.recall(asked);
  size_t answered = 0, spared = 0;
  for (size_t i = 0; i < asked.size(); ++i) {
    const auto expected = memory.drawn(all[i], asked[i].u, i);
    const auto found = memory.drawn(drawn_first[i], asked[i].u, i);
    ASSERT_EQ(expected.has_value(), found.has_value());
    if (expected) {
      EXPECT_EQ(expected->range_m, found->range_m);
      EXPECT_LT(asked[i].u, memory.most_recalled(asked[i].near));
    }
    answered += expected.has_value();
    spared += all[i].count > 0 && drawn_first[i].count == 0;
  }
  EXPECT_GT(answered, 100u);
  EXPECT_GT(spared, 1000u);
}

// The share of simulated returns is what the mixture says that `score` judges.
TEST(Recollection, DrawsAreOfTheMixtureThatIsScored) {
  const elements::Model model = fitted(scanned(kDrive, 0, 0.7), 1);
  const BeamLog test = scanned({1.0, 3.3, 5.2}, 100, 0.7);
  const trace::World world(model);
  const trace::Recollection memory(model);
  std::vector<Ray> rays;
  for (size_t i = 0; i < test.size(); ++i) rays.push_back(test.ray(i));
  trace::IntersectionLists met;
  world.all_intersections(rays, {0, 50}, std::vector<double>(rays.size(), 50), met);
  const std::vector<trace::Recalled> seen = memory.recall(memory.asked(rays, test.ring));
  double misses = 0, variance = 0;
  trace::RangeMixture p;
  for (size_t i = 0; i < rays.size(); ++i) {
    trace::mix_ranges(met[i], 1, 1e-6, p);
    memory.mix(seen[i], p);
    misses += p.miss;
    variance += p.miss * (1 - p.miss);
  }
  const trace::World anew(model, trace::Isa::kBest, trace::Draws::kAnew);
  BeamLog drawn = test;
  simulate::simulate(anew, simulate::Options(), 0, drawn);
  size_t missed = 0;
  for (size_t i = 0; i < drawn.size(); ++i) missed += !drawn.is_hit(i);
  EXPECT_NEAR(double(missed), misses, 4 * std::sqrt(variance) + 1);
}

}  // namespace
}  // namespace underbrush::fit
