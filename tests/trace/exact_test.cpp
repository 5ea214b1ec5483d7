// Tests of the engine against its definition, for every query and instruction set: bundles of rays
// from very narrow ones to the whole sphere, scenes of instances, all kinds of elements, and large
// coordinates.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::trace {
namespace {

constexpr int kScenes = 104, kRaysOfAWorld = 9728;

const std::vector<Isa>& instruction_sets() {
  static const std::vector<Isa> sets = [] {
    std::vector<Isa> found;
    for (Isa isa : {Isa::kBase, Isa::kAvx2, Isa::kAvx512}) {
      const elements::Model nothing;
      try {
        World world(nothing, isa);
        found.push_back(isa);
      } catch (const std::invalid_argument&) {
      }
    }
    return found;
  }();
  return sets;
}

elements::Instance placed(Stream& random, const Vec3& origin, uint32_t model, int kind) {
  elements::Instance i;
  i.model = model;
  for (int k = 0; k < 3; ++k) i.world_from_model.translation[k] = origin[k] + random.uniform(-8, 8);
  const double angle = random.uniform(0, 2 * M_PI);
  if (kind == 1) {  // yaw
    i.world_from_model.rotation = Eigen::AngleAxisd(angle, Vec3::UnitZ());
  } else if (kind == 2) {  // any rotation, any size
    Vec3 axis;
    for (int k = 0; k < 3; ++k) axis[k] = random.normal();
    i.world_from_model.rotation = Eigen::AngleAxisd(angle, axis.normalized());
    i.scale = float(random.uniform(0.3, 3));
  }
  return i;
}

elements::Scene scene_of(uint64_t seed) {
  Stream random(seed * 31);
  const Vec3 origin = seed % 3 == 0 ? Vec3(5e5, -1e6, 300) : Vec3(0, 0, 0);
  elements::Scene scene;
  scene.models.push_back(random_model(seed, seed % 2 ? 110 : 30, origin));
  elements::Instance base;
  base.world_from_model.translation = origin;
  scene.instances.push_back(base);
  if (seed % 2 == 0) {
    scene.models.push_back(random_model(seed + 7000, 12));
    scene.models[1].ground = {};
    scene.models.push_back(random_model(seed + 8000, 5));
    for (int i = 0; i < 5; ++i) {
      scene.instances.push_back(placed(random, origin, 1 + uint32_t(i % 2), i % 3));
    }
    scene.instances.push_back(scene.instances.back());  // two instances in the same place
  }
  if (seed % 8 >= 5) {
    for (elements::Ellipsoid& e : scene.models[0].ellipsoids) {
      if (random.uniform() < 0.7) e.density_per_m = float(std::exp(random.uniform(-2, 4)));
    }
  }
  if (seed % 8 >= 6) {
    scene.models[0].leaf_angles = LeafAngleDistribution(std::exp(random.uniform(-3, 3)));
  }
  if (seed % 8 == 4 || seed % 8 == 5) scene.models[0].voxel_m = random.uniform(0.5, 4);
  for (elements::Model& m : scene.models) {
    constexpr double kSides[4] = {0.004, 0.03, 0.2, 1.7};
    m.grain = {kSides[random.below(4)], kSides[random.below(4)], {}};
    for (uint32_t label = 1; label <= seed % 8; ++label) {  // up to as many as can be
      m.grain.classes.push_back({label, kSides[random.below(4)]});
    }
    for (elements::Ellipsoid& e : m.ellipsoids) e.label = uint32_t(random.below(9));
  }
  scene.check();
  return scene;
}

/// Makes bundles of 64 to a thousand rays from a point, from the exit of a beam or from a moving
/// car.
std::vector<Ray> rays_of(const elements::Scene& scene, Stream& random) {
  std::vector<Ray> rays;
  while (rays.size() < kRaysOfAWorld) {
    const Ray axis = random_ray(random, scene.models[0]);
    constexpr double kSpread[5] = {0, 1e-3, 0.1, 0.6, 5};
    const double spread = kSpread[random.below(5)], mouth = random.below(2) ? 0.02 : 0;
    const double speed = random.below(4) ? 0 : 0.01;
    const size_t n = 64 + random.below(960);
    for (size_t i = 0; i < n && rays.size() < kRaysOfAWorld; ++i) {
      Ray ray = axis;
      for (int k = 0; k < 3; ++k) {
        ray.direction[k] += spread * random.normal();
        ray.origin[k] += mouth * random.normal() + speed * double(i);
      }
      ray.direction.normalize();
      rays.push_back(ray);
    }
  }
  return rays;
}

bool same(const Intersection& a, const Intersection& b) {
  return a.element == b.element && (a.none() || (a.instance == b.instance && a.t_m == b.t_m &&
                                                 a.sigma_m == b.sigma_m && a.p == b.p));
}

/// Whether a ray ends at what it met.
bool ends(Draws draws, const elements::Model& model, const elements::Instance& at, const Ray& ray,
          uint64_t key, const Intersection& m) {
  if (draws == Draws::kAnew) return accepts(key, m);
  const uint32_t cell = Grain(model, at).cell(ray, m);
  if (draws == Draws::kOnce) return accepts(key, m, cell);
  const bool ellipsoid = model.kind(m.element) == elements::Kind::kEllipsoid;
  return accepts(uint32_t(key), m,
                 ellipsoid ? swaying_cell(cell, m.element, uint32_t(key >> 32)) : cell);
}

class Exact : public testing::TestWithParam<int> {};  // each test has an eighth of the scenes

TEST_P(Exact, EveryQueryGivesWhatBruteForceInDoubleGives) {
  size_t asked = 0, met_any = 0, wrong = 0;
  for (uint64_t seed = 1 + uint64_t(GetParam()); seed <= kScenes; seed += 8) {
    const elements::Scene scene = scene_of(seed);
    Stream random(seed + 500);
    const std::vector<Ray> rays = rays_of(scene, random);
    const RangeLimits limits{random.uniform(0, 2), random.uniform(15, 60)};
    // In some scenes the matter is drawn once, where half of the rays have one key, or sways, where
    // all have one draw and the times of a second.
    const Draws draws = std::array{Draws::kAnew, Draws::kOnce, Draws::kSwaying}[seed / 8 % 3];
    std::vector<uint64_t> keys;
    for (size_t i = 0; i < rays.size(); ++i) {
      keys.push_back(beam_key(seed, 0, draws == Draws::kOnce && i % 2 ? 0 : i));
      if (draws != Draws::kSwaying) continue;
      keys.back() = uint64_t(ticks_of(random.uniform(1e9, 1e9 + 1), 0.2)) << 32 | uint32_t(seed);
    }
    std::vector<World> worlds;
    for (Isa isa : instruction_sets()) worlds.emplace_back(scene, isa, draws);
    const size_t sets = worlds.size();
    std::vector<std::vector<Intersection>> nearest(sets, std::vector<Intersection>(rays.size())),
        surface = nearest;
    std::vector<IntersectionLists> all(sets);
    const std::vector<double> everywhere(rays.size(), limits.max_m);
    for (size_t w = 0; w < sets; ++w) {
      worlds[w].nearest_accepted(rays, keys, limits, nearest[w]);
      worlds[w].nearest_surface(rays, limits, surface[w]);
      worlds[w].all_intersections(rays, limits, everywhere, all[w]);
    }
    for (size_t i = 0; i < rays.size(); ++i) {
      std::vector<Intersection> met;
      for (uint32_t n = 0; n < scene.instances.size(); ++n) {
        const elements::Model& model = scene.models[scene.instances[n].model];
        for (uint32_t e = 0; e < model.size(); ++e) {
          const Intersection m = intersect(model, scene.instances[n], n, e, rays[i], limits);
          if (!m.none()) met.push_back(m);
        }
      }
      std::sort(met.begin(), met.end(),
                [](const Intersection& a, const Intersection& b) { return a.before(b); });
      Intersection first, wall;
      for (const Intersection& m : met) {
        const elements::Instance& at = scene.instances[m.instance];
        const elements::Model& model = scene.models[at.model];
        if (first.none() && ends(draws, model, at, rays[i], keys[i], m)) first = m;
        if (wall.none() && model.kind(m.element) != elements::Kind::kEllipsoid) wall = m;
      }
      for (size_t w = 0; w < sets; ++w) {
        wrong += !same(nearest[w][i], first);
        wrong += !same(surface[w][i], wall);
        const auto list = all[w][i];
        wrong +=
            list.size() != met.size() || !std::equal(list.begin(), list.end(), met.begin(), same);
      }
      met_any += !first.none();
      ++asked;
    }
    ASSERT_EQ(wrong, 0u) << "seed " << seed;
  }
  EXPECT_GT(met_any, asked / 6);
}

INSTANTIATE_TEST_SUITE_P(Trace, Exact, testing::Range(0, 8));

static_assert(size_t(kScenes) * kRaysOfAWorld >= 1000000);

TEST(Exact, DoesNotDependOnHowTheRaysAreCutIntoCallsNorOnThreads) {
  const elements::Scene scene = scene_of(2);
  const World world(scene);
  Stream random(9);
  const std::vector<Ray> rays = rays_of(scene, random);
  std::vector<uint64_t> keys(rays.size());
  for (size_t i = 0; i < keys.size(); ++i) keys[i] = beam_key(1, 2, i);
  std::vector<Intersection> whole(rays.size()), pieces(rays.size());
  world.nearest_accepted(rays, keys, {}, whole);
  for (int threads : {1, 2}) {
    set_threads(threads);
    parallel_for(rays.size(), 777, [&](size_t begin, size_t end) {
      const size_t n = end - begin;
      world.nearest_accepted({&rays[begin], n}, {&keys[begin], n}, {}, {&pieces[begin], n});
    });
    for (size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(same(whole[i], pieces[i])) << i;
  }
  set_threads(0);
}

}  // namespace
}  // namespace underbrush::trace
