#include "underbrush/trace/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::trace {
namespace {

// Applies the definition by brute force in double precision.
std::vector<Intersection> reference(const elements::Model& model, const Ray& ray,
                                    const RangeLimits& limits) {
  std::vector<Intersection> met;
  for (uint32_t i = 0; i < model.size(); ++i) {
    const Intersection m = intersect(model, i, ray.origin - model.origin, ray.direction, limits);
    if (!m.none()) met.push_back(m);
  }
  std::sort(met.begin(), met.end(),
            [](const Intersection& a, const Intersection& b) { return a.before(b); });
  return met;
}

bool accepts(const elements::Model& model, uint64_t key, uint32_t element) {
  const float p = model.hit(element).p;
  return p >= 1 || double(accept_bits(key, element)) < double(p) * 4294967296.0;
}

class Instructions : public testing::TestWithParam<Isa> {};

TEST_P(Instructions, AllThreeQueriesEqualBruteForceElementByElement) {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const Vec3 origin = seed % 3 == 0 ? Vec3(5e5, -1e6, 300) : Vec3(0, 0, 0);
    const elements::Model model = random_model(seed, 300, origin);
    World world(model, GetParam());
    Stream random(seed + 1000);
    std::vector<Intersection> met;
    const RangeLimits limits{random.uniform(0, 2), random.uniform(20, 80)};
    for (int i = 0; i < 250; ++i) {
      const Ray ray = random_ray(random, model);
      const std::vector<Intersection> expected = reference(model, ray, limits);
      world.all_intersections(ray, limits, limits.max_m, met);
      ASSERT_EQ(met.size(), expected.size()) << "seed " << seed << " ray " << i;
      const uint64_t key = beam_key(seed, 0, uint64_t(i));
      uint32_t first = Intersection::kNone, surface = Intersection::kNone;
      for (size_t k = 0; k < met.size(); ++k) {
        EXPECT_EQ(met[k].element, expected[k].element);
        EXPECT_EQ(met[k].t_m, expected[k].t_m);
        const uint32_t e = expected[k].element;
        if (first == Intersection::kNone && accepts(model, key, e)) first = e;
        if (surface == Intersection::kNone && model.kind(e) != elements::Kind::kEllipsoid)
          surface = e;
      }
      EXPECT_EQ(world.nearest_accepted(ray, key, limits).element, first);
      EXPECT_EQ(world.nearest_surface(ray, limits).element, surface);
    }
  }
}

TEST_P(Instructions, GroundHasNoGapsAlongItsEdges) {
  elements::Model model = random_model(5, 0);
  model.ellipsoids.clear();
  for (auto& h : model.ground.hit) h.p = 1;
  World world(model, GetParam());
  Stream random(77);
  for (int i = 0; i < 50000; ++i) {
    const auto& t = model.ground.triangles[random.below(model.ground.size())];
    const double s = random.uniform() < 0.1 ? 0 : random.uniform();
    const Vec3 a = model.ground.vertices[t[0]].cast<double>();
    const Vec3 b = model.ground.vertices[t[1]].cast<double>();
    Vec3 target = a + s * (b - a);
    if (std::abs(target.x()) > 18 || std::abs(target.y()) > 18) continue;
    Ray ray;
    ray.origin = Vec3(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(12, 20));
    ray.direction = (target - ray.origin).normalized();
    bool ground = false;
    std::vector<Intersection> met;
    world.all_intersections(ray, {0, 200}, 200, met);
    for (const Intersection& m : met) ground |= model.kind(m.element) == elements::Kind::kGround;
    EXPECT_TRUE(ground) << "leak at ray " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Trace, Instructions, testing::Values(Isa::kBase, Isa::kBest));

TEST(World, OfNothingAnswersNothing) {
  const elements::Model model;
  World world(model);
  std::vector<Intersection> met;
  world.all_intersections({}, {}, 100, met);
  EXPECT_TRUE(met.empty());
  EXPECT_TRUE(world.nearest_accepted({}, 1, {}).none());
}

// P(first = k) = p_k ∏_{j<k} (1 − p_j) must hold over the beams' keys.
TEST(World, AcceptsAsTrialsInOrderWould) {
  elements::Model model;
  const double p[3] = {0.3, 0.5, 0.8};
  // numbered from back to front, so that the order must come from the range
  for (int k = 2; k >= 0; --k) {
    elements::Ellipsoid e;
    e.mean = Vec3f(float(10 + k), 0, 0);
    e.set_covariance(0.01 * Mat3::Identity());
    e.hit.p = float(p[k]);
    model.ellipsoids.push_back(e);
  }
  World world(model);
  const int n = 200000;
  std::vector<double> count(4);
  for (int i = 0; i < n; ++i) {
    const Intersection m = world.nearest_accepted({}, beam_key(9, 0, uint64_t(i)), {0, 100});
    ++count[m.none() ? 3 : 2 - m.element];
  }
  double through = 1, chi2 = 0;
  for (int k = 0; k < 4; ++k) {
    const double expected = n * through * (k < 3 ? p[k] : 1);
    if (k < 3) through *= 1 - p[k];
    chi2 += (count[k] - expected) * (count[k] - expected) / expected;
  }
  EXPECT_LT(chi2, 25);  // 3 degrees of freedom
}

TEST(World, IsTheSameWhateverTheNumberOfThreadsThatBuiltIt) {
  const elements::Model model = random_model(8, 20000);
  set_threads(1);
  World one(model);
  set_threads(0);
  World many(model);
  Stream random(3);
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = random_ray(random, model);
    EXPECT_EQ(one.nearest_accepted(ray, uint64_t(i), {0, 90}).element,
              many.nearest_accepted(ray, uint64_t(i), {0, 90}).element);
  }
}

}  // namespace
}  // namespace underbrush::trace
