#include "underbrush/likelihood/meetings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "likelihood/beams_above_ground.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/likelihood/expectation.hpp"

namespace underbrush::likelihood {
namespace {

/// Makes ellipsoids of all shapes over a ground, far from the world's origin.
elements::Model random_model(uint64_t seed, size_t n) {
  elements::Model m;
  m.origin = Vec3(4e5, 5e6, 100);
  m.ground = test::level_ground(0.02);
  m.ground.hit = {{0.9f, 0, 0}, {0.8f, 0, 0}};
  Stream random(seed);
  for (size_t k = 0; k < n; ++k) {
    elements::Ellipsoid e;
    for (int a = 0; a < 3; ++a) e.mean[a] = float(random.uniform(-6, 6));
    e.mean[2] = 0.2f * e.mean[2] + 1.5f;
    Mat3 root = Mat3::Zero();
    for (int i = 0; i < 3; ++i) {
      root(i, i) = random.uniform(0.05, 0.3);
      for (int j = 0; j < i; ++j) root(i, j) = random.uniform(-0.1, 0.1);
    }
    e.set_covariance(root * root.transpose());
    e.density_per_m = float(std::exp(random.uniform(-3, 3)));
    m.ellipsoids.push_back(e);
  }
  return m;
}

/// Makes beams that return anywhere on their way, and misses.
BeamLog random_beams(uint64_t seed, size_t n, const Vec3& at) {
  BeamLog log = test::random_beams(seed, n, {{0, 2 * M_PI}, {-0.3, 0.3}, {-4, 4}, {-4, 4}}, at);
  Stream random(seed + 1);
  for (size_t i = 0; i < n; ++i) log.range_m[i] = i % 5 ? float(random.uniform(0.5, 12)) : kMiss;
  return log;
}

void expect_same(const Expectation& a, const Expectation& b, const elements::Model& model) {
  EXPECT_EQ(a.nll, b.nll);
  EXPECT_EQ(a.stray_hits, b.stray_hits);
  for (size_t k = 0; k < model.ellipsoids.size(); ++k) {
    const EllipsoidSums x = a.sums.ellipsoid(k), y = b.sums.ellipsoid(k);
    EXPECT_EQ(x.hits, y.hits) << k;
    EXPECT_EQ(x.passes, y.passes) << k;
    EXPECT_EQ(x.shift_slope, y.shift_slope) << k;
    EXPECT_EQ(x.stretch_curvature, y.stretch_curvature) << k;
  }
  EXPECT_EQ(a.sums.triangle(0).passes, b.sums.triangle(0).passes);
  EXPECT_EQ(a.sums.noise(elements::Kind::kGround).slope,
            b.sums.noise(elements::Kind::kGround).slope);
}

constexpr size_t kMany = size_t(1) << 30;

TEST(Meetings, AreThoseThatTheRayModelHas) {
  const elements::Model model = random_model(31, 150);
  const BeamLog log = random_beams(32, 3000, model.origin);
  MemorySource source(log, 2500);
  const trace::World world(model);
  size_t needed = 0, listed = 0, triangles = 0;
  const ListedBeams beams(source, credit::HeldOut{0}, model, kMany);
  beams.for_each({}, [&](std::span<const ListedBeam> some) {
    BeamBlock block;
    block.beams = some;
    find_meetings(world, log.info, block);
    listed += block.met.size();
    for (size_t b = 0; b < block.beams.size(); ++b) {
      const ListedBeam& beam = block.beams[b];
      const Vec3f origin(beam.origin), direction(beam.direction);
      const auto from = block.met.begin() + block.first[b],
                 to = block.met.begin() + block.first[b + 1];
      for (uint32_t e = 0; e < model.size(); ++e) {
        const trace::Intersection m =
            trace::intersect(model, e, origin.cast<double>(), direction.cast<double>(),
                             {log.info.min_range_m, double(beam.reach_m)});
        if (m.none() || m.t_m - double(kFarthestMisfit) * m.sigma_m > double(beam.range_m))
          continue;
        ++needed;
        const auto at = std::find(from, to, e);
        ASSERT_NE(at, to) << b << " " << e;
        if (e >= 2) continue;
        const TriangleMeeting& t = block.on_triangle[block.first_triangle[b] + size_t(at - from)];
        EXPECT_NEAR(t.t_m, m.t_m, 1e-5);
        const double cosine =
            std::max(std::abs(double(direction.z())), 0.01);  // the ground is level
        EXPECT_NEAR(t.tilt, 1 / (cosine * cosine), 1e-3 * t.tilt);
        ++triangles;
      }
    }
    EXPECT_EQ(block.on_triangle.size(), block.first_triangle.back());
  });
  EXPECT_GT(triangles, 100u);
  EXPECT_GT(needed, 3000u);
  // Few are listed in vain.
  EXPECT_LT(double(listed), 1.3 * double(needed));
}

TEST(ListedBeams, ThatAreNotKeptGiveTheSame) {
  const elements::Model model = random_model(34, 60);
  const BeamLog log = random_beams(35, 5000, model.origin);
  MemorySource source(log, 1000);
  const trace::World world(model);
  const ListedBeams kept(source, credit::HeldOut{}, model, kMany);
  EXPECT_EQ(kept.training_beams() + kept.held_out().size(), log.size());
  const Expectation all = expect(world, kept, {}, {});
  for (const size_t bytes : {size_t(0), size_t(70000)}) {
    const ListedBeams some(source, credit::HeldOut{}, model, bytes);
    EXPECT_EQ(some.training_beams(), kept.training_beams());
    expect_same(expect(world, some, {}, {}), all, model);
    expect_same(expect(world, some, {1, 3}, {}), expect(world, kept, {1, 3}, {}), model);
    EXPECT_EQ(validation_nll(world, some), validation_nll(world, kept));
  }
}

TEST(ListedBeams, AreJudgedAsTheyAreLearntFrom) {
  const elements::Model model = random_model(36, 80);
  const BeamLog log = random_beams(37, 6000, model.origin);
  MemorySource source(log, 1000);
  const trace::World world(model);
  const double learnt =
      expect(world, ListedBeams(source, credit::HeldOut{0}, model, kMany), {}, {}).nll;
  const ListedBeams all_apart(source, credit::HeldOut{1}, model, kMany);
  EXPECT_EQ(validation_nll(world, all_apart), learnt);
  EXPECT_EQ(all_apart.held_out_hits(), 4800u);
}

/// Shares whose numbers add up to all have no beam in common and leave none out: the sums of four
/// quarters, which count their beams four times, are four times those of all beams, to the bit.
TEST(ListedBeams, SharesAddUpToAllBeams) {
  const elements::Model model = random_model(40, 60);
  const BeamLog log = random_beams(41, 5000, model.origin);
  MemorySource source(log, 1000);
  const trace::World world(model);
  const ListedBeams beams(source, credit::HeldOut{0}, model, kMany);
  const ElementSums all = expect(world, beams, {}, {}).sums;
  std::vector<double> hits(60);
  double passes = 0, slope = 0;
  for (unsigned k = 0; k < credit::BeamShare::kParts; k += 2) {
    size_t count = 0;
    beams.for_each({k, k + 2}, [&](std::span<const ListedBeam> some) { count += some.size(); });
    EXPECT_NEAR(double(count), 1250, 130);
    const ElementSums quarter = expect(world, beams, {k, k + 2}, {}).sums;
    for (size_t e = 0; e < hits.size(); ++e) hits[e] += quarter.ellipsoid(e).hits;
    passes += quarter.triangle(0).passes;
    slope += quarter.noise(elements::Kind::kGround).slope;
  }
  for (size_t e = 0; e < hits.size(); ++e) EXPECT_EQ(hits[e], 4 * all.ellipsoid(e).hits) << e;
  EXPECT_EQ(passes, 4 * all.triangle(0).passes);
  EXPECT_EQ(slope, 4 * all.noise(elements::Kind::kGround).slope);
}

TEST(Expectation, HasTheSameBitsForAnyNumberOfThreads) {
  const elements::Model model = random_model(42, 60);
  const BeamLog log = random_beams(43, 20000, model.origin);
  MemorySource source(log);
  const trace::World world(model);
  const ListedBeams beams(source, credit::HeldOut{}, model, kMany);
  set_threads(1);
  const Expectation alone = expect(world, beams, {}, {});
  set_threads(0);
  for (int k = 0; k < 4; ++k) expect_same(expect(world, beams, {}, {}), alone, model);
}

#if defined(__x86_64__)
TEST(PassKernel, GivesTheSameBitsForEachInstructionSet) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP();
  const elements::Model model = random_model(38, 1);
  const ModelForms forms(model, 0.2);
  const ModelForm form = forms.view();
  Stream random(39);
  std::vector<ListedBeam> beams;
  std::vector<uint32_t> first{0}, met;
  std::vector<TriangleMeeting> on_triangle;
  std::vector<float> shares[2];
  for (uint32_t b = 0; b < 1000; ++b) {
    const Vec3f d =
        Vec3f(float(random.normal()), float(random.normal()), float(random.normal())).normalized();
    const Vec3f o = model.ellipsoids[0].mean - float(random.uniform(2, 9)) * d;
    beams.push_back({{o[0] + float(random.uniform(-0.3, 0.3)), o[1], o[2]},
                     float(random.uniform(1, 9)),
                     {d[0], d[1], d[2]},
                     30});
    met.push_back(b % 9 ? 2u : b % 2);
    if (met.back() < 2) on_triangle.push_back({5, 1.5f});
    first.push_back(b + 1);
    for (std::vector<float>& s : shares) s.push_back(float(random.uniform()));
  }
  std::vector<const PassKernels*> kernels{&kPassBase, &kPassAvx2};
  if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    kernels.push_back(&kPassAvx512);
  }
  std::vector<std::array<std::vector<float>, 4>> columns(kernels.size());
  std::vector<std::array<int64_t, kSumRow>> sums(kernels.size());
  for (size_t k = 0; k < kernels.size(); ++k) {
    RunColumns run;
    run.resize(1000);
    const MeetingColumns c = run.meetings();
    const size_t count = kernels[k]->approach(form, beams.data(), first.data(), 0, 1000, met.data(),
                                              on_triangle.data(), c, run.ellipsoids());
    EXPECT_EQ(count, 1000 - on_triangle.size());
    size_t column = 0;
    for (const float* x : {c.t_m, c.sigma_m, c.p, c.density}) {
      columns[k][column++].assign(x, x + 1000);
    }
    uint8_t lock = 0;
    kernels[k]->add(run.ellipsoids(), count, met.data(), 2, {shares[0].data(), shares[1].data()},
                    {sums[k].data(), &lock, 0});
    EXPECT_EQ(lock, 0);
  }
  for (size_t k = 0; k < kernels.size(); ++k) {
    EXPECT_EQ(columns[k], columns[0]) << k;
    EXPECT_EQ(sums[k], sums[0]) << k;
  }
  EXPECT_NE(sums[0][kAlong], 0);
}
#endif

}  // namespace
}  // namespace underbrush::likelihood
