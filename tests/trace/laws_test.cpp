// Tests of laws that hold for every scene: meshes have no leaks, answers do not depend on where the
// world lies, voxels are met as by a walk through the grid, copies have independent trials, and
// memory is bounded.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scenes.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::trace {
namespace {

elements::TriangleMesh bumpy_ground(int cells, double cell_m) {
  Stream random(12);
  elements::TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      mesh.vertices.emplace_back(float((i - cells / 2) * cell_m), float((j - cells / 2) * cell_m),
                                 float(random.uniform(-0.3, 0.3)));
    }
  }
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      const uint32_t a = uint32_t(i * (cells + 1) + j), b = a + uint32_t(cells) + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  mesh.hit.resize(mesh.size());
  return mesh;
}

TEST(Ground, LetsNoneOfTenMillionRaysThrough) {
  elements::Model model;
  model.ground = bumpy_ground(100, 0.4);
  const World world(model);
  Stream random(77);
  size_t leaks = 0, shot = 0;
  std::vector<Ray> rays(8192);
  std::vector<Intersection> met(rays.size());
  const std::vector<uint64_t> keys(rays.size(), 1);
  while (shot < 10000000) {
    // Rays are so steep that one which only touches a ridge comes down again within the mesh.
    const Vec3 origin(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(4, 9));
    const Vec3 centre(random.uniform(-9, 9), random.uniform(-9, 9), 0);
    const double spread = random.uniform(0.2, 6);
    for (Ray& ray : rays) {
      Vec3 target = centre;
      if (random.below(4) > 0) {  // an edge, or an end of an edge, of a triangle near the centre
        const int i = std::clamp(int((centre.x() + spread * random.normal()) / 0.4) + 50, 25, 74);
        const int j = std::clamp(int((centre.y() + spread * random.normal()) / 0.4) + 50, 25, 74);
        const auto& t = model.ground.triangles[size_t(2 * (100 * i + j)) + random.below(2)];
        const uint64_t corner = random.below(3);
        const double s = random.below(4) ? random.uniform() : 0;
        const Vec3 a = model.ground.vertices[t[corner]].cast<double>();
        target = a + s * (model.ground.vertices[t[(corner + 1) % 3]].cast<double>() - a);
      } else {
        target += spread * Vec3(random.normal(), random.normal(), 0);
        target = Vec3(target.x(), target.y(), 0).cwiseMax(-10).cwiseMin(10) - 0.4 * Vec3::UnitZ();
      }
      ray = {origin, (target - origin).normalized()};
    }
    world.nearest_accepted(rays, keys, {0, 200}, met);
    for (const Intersection& m : met) leaks += m.none();
    shot += rays.size();
  }
  EXPECT_EQ(leaks, 0u);
}

TEST(World, FindsFarFromTheOriginWhatItFindsThere) {
  const Vec3 far(500000, -350000, 1000);
  const elements::Model near_model = random_model(21, 2000);
  elements::Model far_model = near_model;
  far_model.origin = far;
  const World here(near_model), there(far_model);
  Stream random(22);
  std::vector<Ray> rays, moved;
  std::vector<uint64_t> keys;
  for (int i = 0; i < 200000; ++i) {
    Ray ray = random_ray(random, near_model);
    // exact at that distance, too
    for (double& x : ray.origin) x = std::round(x * 0x1p20) * 0x1p-20;
    rays.push_back(ray);
    moved.push_back({ray.origin + far, ray.direction});
    keys.push_back(beam_key(3, 0, uint64_t(i)));
  }
  std::vector<Intersection> a(rays.size()), b(rays.size());
  here.nearest_accepted(rays, keys, {0, 100}, a);
  there.nearest_accepted(moved, keys, {0, 100}, b);
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(a[i].element, b[i].element);
    EXPECT_EQ(a[i].t_m, b[i].t_m);
  }
}

// The reference walks from cell to cell ([deschaud12] §III.C.1; Amanatides & Woo 1987). In each
// cell that the ray passes, it meets the cell's ellipsoid if the closest approach lies in the cell.
TEST(Voxels, AreMetAsAWalkThroughTheGridMeetsThem) {
  Stream random(31);
  elements::Model model;
  model.voxel_m = 0.5;
  model.tau = 2;
  std::map<std::array<int64_t, 3>, uint32_t> element_of;
  while (model.ellipsoids.size() < 4000) {
    elements::Ellipsoid e;
    for (int k = 0; k < 3; ++k) e.mean[k] = float(random.uniform(-5, 5));
    const auto cell = voxel_of(e.mean.cast<double>(), model.voxel_m);
    if (!element_of.emplace(cell, uint32_t(model.ellipsoids.size())).second) continue;
    e.set_covariance(random_covariance(random, 0.03, 0.2));
    model.ellipsoids.push_back(e);
  }
  const World world(model);
  size_t met_any = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = random_ray(random, model);
    std::vector<Intersection> met;
    world.all_intersections(ray, {0, 60}, 60, met);
    std::vector<uint32_t> walked;
    auto cell = voxel_of(ray.origin, model.voxel_m);
    Vec3 next, step;  // ranges to the next wall along each axis, and between walls
    for (int k = 0; k < 3; ++k) {
      const double d = ray.direction[k];
      const double wall = (double(cell[size_t(k)]) + (d > 0)) * model.voxel_m;
      next[k] = d == 0 ? INFINITY : (wall - ray.origin[k]) / d;
      step[k] = d == 0 ? INFINITY : model.voxel_m / std::abs(d);
    }
    for (double t = 0; t < 60;) {
      if (const auto found = element_of.find(cell); found != element_of.end()) {
        const elements::Ellipsoid& e = model.ellipsoids[found->second];
        const Intersection m = approach(ray.origin, ray.direction, e.mean, e.covariance);
        if (m.delta2 <= 4 && m.t_m >= t && m.t_m < next.minCoeff()) walked.push_back(found->second);
      }
      int axis;
      t = next.minCoeff(&axis);
      next[axis] += step[axis];
      cell[size_t(axis)] += ray.direction[axis] > 0 ? 1 : -1;
    }
    ASSERT_EQ(met.size(), walked.size()) << i;
    for (size_t k = 0; k < met.size(); ++k) EXPECT_EQ(met[k].element, walked[k]);
    met_any += !met.empty();
  }
  EXPECT_GT(met_any, 3000u);
}

TEST(PathLengthOpacity, IsThatOfTheLineThroughTheGaussian) {
  elements::Model model;
  elements::Ellipsoid e;
  e.mean = Vec3f(10, 0, 0);
  e.set_covariance(Vec3(0.04, 0.09, 0.01).asDiagonal());
  e.density_per_m = 1.5f;
  model.ellipsoids = {e};
  const World world(model);
  for (double offset : {0.0, 0.3, 0.6}) {
    const Ray ray{Vec3(0, offset, 0), Vec3::UnitX()};
    // The optical depth is ∫ κ exp(−δ²(t)/2) dt along the ray, by the midpoint rule.
    double optical = 0;
    for (double t = 8; t < 12; t += 1e-3) {
      const double x = (t + 5e-4 - 10) / 0.2, y = offset / 0.3;
      optical += 1.5 * std::exp(-0.5 * (x * x + y * y)) * 1e-3;
    }
    std::vector<Intersection> met;
    world.all_intersections(ray, {0, 50}, 50, met);
    ASSERT_EQ(met.size(), 1u);
    EXPECT_NEAR(met[0].p, 1 - std::exp(-optical), 1e-6);
    // The same share of beams must be stopped.
    size_t stopped = 0;
    const size_t n = 40000;
    const std::vector<Ray> rays(n, ray);
    std::vector<uint64_t> keys(n);
    for (size_t i = 0; i < n; ++i) keys[i] = beam_key(5, 0, i);
    std::vector<Intersection> ends(n);
    world.nearest_accepted(rays, keys, {0, 50}, ends);
    for (const Intersection& m : ends) stopped += !m.none();
    const double p = met[0].p, sigma = std::sqrt(p * (1 - p) / double(n));
    EXPECT_NEAR(double(stopped) / double(n), p, 4 * sigma);
  }
}

TEST(Instances, OfOnePrimitiveDecideIndependently) {
  elements::Scene scene;
  scene.models.resize(1);
  elements::Ellipsoid e;
  e.set_covariance(0.01 * Mat3::Identity());
  e.hit.p = 0.5f;
  scene.models[0].ellipsoids = {e};
  for (int k = 0; k < 2; ++k) {
    elements::Instance placed;
    placed.world_from_model.translation = Vec3(5 + 2 * k, 0, 0);
    scene.instances.push_back(placed);
  }
  const World world(scene);
  double count[2] = {};
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const Intersection m = world.nearest_accepted({}, beam_key(6, 0, uint64_t(i)), {0, 50});
    if (!m.none()) ++count[m.instance];
  }
  EXPECT_NEAR(count[0] / n, 0.5, 0.008);
  EXPECT_NEAR(count[1] / n, 0.25, 0.007);
}

TEST(World, KeepsWithinItsMemory) {
  Stream random(41);
  elements::Model tree;
  for (int i = 0; i < 20000; ++i) {
    elements::Ellipsoid e;
    for (int k = 0; k < 3; ++k) e.mean[k] = float(2 * random.normal());
    e.set_covariance(random_covariance(random, 0.03, 0.15));
    tree.ellipsoids.push_back(e);
  }
  const size_t of_tree = World(tree).bytes();
  EXPECT_LE(double(of_tree) / 20000, 64);
  elements::Scene scene;
  scene.models = {tree};
  const size_t n = 20000;
  for (size_t i = 0; i < n; ++i) {
    elements::Instance placed;
    placed.world_from_model.rotation = Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ());
    placed.world_from_model.translation = Vec3(random.uniform(0, 900), random.uniform(0, 900), 0);
    scene.instances.push_back(placed);
  }
  const double each = double(World(scene).bytes() - of_tree) / double(n);
  EXPECT_LE(each + sizeof(elements::Instance), 220);
}

}  // namespace
}  // namespace underbrush::trace
