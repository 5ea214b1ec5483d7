#include "underbrush/fit/meetings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/fit/expectation.hpp"

namespace underbrush::fit {
namespace {

/// Makes ellipsoids of all shapes over a ground, far from the world's origin.
elements::Model random_model(uint64_t seed, size_t n) {
  elements::Model m;
  m.origin = Vec3(4e5, 5e6, 100);
  m.ground.vertices = {{-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}};
  m.ground.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.ground.hit = {{0.9f, 0, 0}, {0.8f, 0, 0}};
  m.ground.range_sigma_m = 0.01;
  m.ground.roughness_m = 0.02;
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
  BeamLog log;
  log.info.max_range_m = 40;
  log.info.min_range_m = 0.2;
  log.info.has_misses = true;
  log.resize(n);
  Stream random(seed);
  for (size_t i = 0; i < n; ++i) {
    const double azimuth = random.uniform(0, 2 * M_PI), elevation = random.uniform(-0.3, 0.3);
    log.origin[i] = at + Vec3(random.uniform(-4, 4), random.uniform(-4, 4), 1.5);
    log.direction[i] =
        Vec3f(float(std::cos(azimuth) * std::cos(elevation)),
              float(std::sin(azimuth) * std::cos(elevation)), float(std::sin(elevation)));
    log.range_m[i] = i % 5 ? float(random.uniform(0.5, 12)) : kMiss;
    log.scan[i] = uint32_t(i / 1000);
    log.packet[i] = uint32_t(i / 50);
  }
  return log;
}

void expect_same(const Expectation& a, const Expectation& b, const elements::Model& model) {
  EXPECT_EQ(a.training_nll, b.training_nll);
  EXPECT_EQ(a.held_out_nll, b.held_out_nll);
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

constexpr double kScale = 1.4;
constexpr size_t kMany = size_t(1) << 30;

TEST(Meetings, APassOverListsIsThatOfASearchAfterEllipsoidsMoved) {
  const elements::Model model = random_model(31, 150);
  const BeamLog log = random_beams(32, 6000, model.origin);
  MemorySource source(log, 2500);
  const Meetings lists(model, kScale, source, HeldOut{}, kMany);
  elements::Model moved = model;
  Stream random(33);
  for (elements::Ellipsoid& e : moved.ellipsoids) {
    const Mat3 root = Eigen::LLT<Mat3>(e.covariance_matrix()).matrixL();
    Mat3 stretch = Mat3::Identity();
    for (int k = 0; k < 9; ++k) stretch(k / 3, k % 3) += random.uniform(-0.15, 0.15);
    const Vec3 shift(random.normal(), random.normal(), random.normal());
    e.mean += (0.4 * root * shift).cast<float>();
    e.set_covariance(root * stretch * stretch.transpose() * root.transpose());
    e.density_per_m *= 1.5f;
  }
  moved.ground.roughness_m = 0.05;
  const size_t held_back = lists.keep_within_bounds(model, moved);
  EXPECT_GT(held_back, 10u);
  EXPECT_LT(held_back, 140u);
  const Expectation fresh = expect(moved, source, HeldOut{}, {});
  expect_same(expect(moved, lists, {}), fresh, moved);
  // Lists without bounds miss what the ellipsoids have moved to.
  EXPECT_NE(expect(moved, Meetings(model, 1, source, HeldOut{}, kMany), {}).training_nll,
            fresh.training_nll);
}

TEST(Meetings, ListsThatAreNotKeptGiveTheSame) {
  const elements::Model model = random_model(34, 60);
  const BeamLog log = random_beams(35, 5000, model.origin);
  MemorySource source(log, 1000);
  const Meetings kept(model, kScale, source, HeldOut{}, kMany);
  const Expectation all = expect(model, kept, {});
  EXPECT_EQ(all.training_beams + all.held_out_beams, log.size());
  for (const size_t bytes : {size_t(0), size_t(200000)}) {
    expect_same(expect(model, Meetings(model, kScale, source, HeldOut{}, bytes), {}), all, model);
  }
}

/// Splits and removals keep their lists exactly; a merge may lose what only the rim meets.
TEST(Meetings, AreInheritedInARearrangement) {
  const elements::Model model = random_model(36, 80);
  const BeamLog log = random_beams(37, 6000, model.origin);
  MemorySource source(log);
  const Meetings lists(model, kScale, source, HeldOut{}, kMany);
  Rearranged after{model, {}};
  after.model.ellipsoids.clear();
  std::vector<elements::Ellipsoid> second;
  for (uint32_t k = 0; k < 80; ++k) {
    after.heirs.push_back({Rearranged::kNone, Rearranged::kNone});
    if (k % 4 == 0) continue;
    const auto two = halves(model.ellipsoids[k]);
    after.heirs.back() = {uint32_t(after.model.ellipsoids.size()), uint32_t(60 + second.size())};
    after.model.ellipsoids.push_back(two[0]);
    second.push_back(two[1]);
  }
  after.model.ellipsoids.insert(after.model.ellipsoids.end(), second.begin(), second.end());
  const Meetings halved(lists, after);
  expect_same(expect(after.model, halved, {}), expect(after.model, source, HeldOut{}, {}),
              after.model);
  Rearranged merge{after.model, {}};
  merge.model.ellipsoids.clear();
  for (uint32_t k = 0; k < 60; ++k) {
    merge.model.ellipsoids.push_back(
        merged(after.model.ellipsoids[k], 1, after.model.ellipsoids[60 + k], 1));
  }
  for (uint32_t k = 0; k < 120; ++k) merge.heirs.push_back({k % 60, Rearranged::kNone});
  EXPECT_NEAR(expect(merge.model, Meetings(halved, merge), {}).training_nll,
              expect(merge.model, source, HeldOut{}, {}).training_nll, 1e-4);
}

#if defined(__x86_64__)
TEST(PassKernel, GivesTheSameBitsForEachInstructionSet) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP();
  const elements::Model model = random_model(38, 1);
  const ModelForms forms(model, 0.2);
  const ModelForm form = forms.view();
  Stream random(39);
  BeamBlock block;
  std::vector<ElementMeeting> list;
  std::vector<float> shares[3];
  block.first = {0};
  for (uint32_t b = 0; b < 1000; ++b) {
    const Vec3f d =
        Vec3f(float(random.normal()), float(random.normal()), float(random.normal())).normalized();
    const Vec3f o = model.ellipsoids[0].mean - float(random.uniform(2, 9)) * d;
    block.beams.push_back({{o[0] + float(random.uniform(-0.3, 0.3)), o[1], o[2]},
                           float(random.uniform(1, 9)),
                           {d[0], d[1], d[2]},
                           30});
    block.met.push_back(b % 9 ? 2u : b % 2);
    if (block.met.back() < 2) block.on_triangle.push_back({5, 1.5f});
    block.first.push_back(b + 1);
    list.push_back({b, b});
    for (std::vector<float>& s : shares) s.push_back(float(random.uniform()));
  }
  std::vector<float> columns[2][4];
  std::vector<int64_t> sums[2];
  const PassKernels* kernels[2] = {&kPassBase, &kPassAvx2};
  for (int k = 0; k < 2; ++k) {
    for (std::vector<float>& c : columns[k]) c.resize(1008);
    sums[k].resize(kSumFields);
    auto& [t, sigma, p, density] = columns[k];
    kernels[k]->approach(form, block.beams.data(), block.first.data(), 0, 1000, block.met.data(),
                         block.on_triangle.data(),
                         {t.data(), sigma.data(), p.data(), density.data()});
    kernels[k]->add(form.ellipsoids[0], block.beams.data(), list.data(), 1000,
                    {shares[0].data(), shares[1].data(), shares[2].data()}, sums[k].data());
  }
  for (int c = 0; c < 4; ++c) {
    columns[0][c].resize(1000), columns[1][c].resize(1000);
    EXPECT_EQ(columns[0][c], columns[1][c]) << c;
  }
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_NE(sums[0][kAlong], 0);
}
#endif

}  // namespace
}  // namespace underbrush::fit
