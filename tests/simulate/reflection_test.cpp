#include "underbrush/simulate/reflection.hpp"

#include <gtest/gtest.h>

#include "simulate/targets.hpp"

namespace underbrush::simulate {
namespace {

TEST(Reflection, TakesTheMaterialOfTheInstanceThenOfItsClassThenOfTheElement) {
  elements::Scene scene;
  elements::Model model;
  add_wall(model, 20);
  elements::Ellipsoid e;
  e.mean = Vec3f(10, 0, 0);
  e.label = uint32_t(elements::Class::kGrass);
  model.ellipsoids.push_back(e);
  scene.models.push_back(model);
  scene.instances.resize(3);
  const trace::World world(scene);
  const DynamicWorld dynamic_world(world);
  radiometry::Materials m = radiometry::load_materials();
  m.of_class = {{"unknown", "white_target"}, {"grass", "snow"}, {"large_tree", "grey_target"}};
  InstanceKinds kinds;
  kinds.label = {elements::Class::kUnknown, elements::Class::kLargeTree, elements::Class::kUnknown};
  kinds.material = {"", "", "asphalt"};
  const Reflection reflection(m, 905e-9, kinds);
  Reflection::Evaluator evaluator(reflection, dynamic_world);
  evaluator.begin(Vec3::UnitX(), 0);
  const auto factor = [&](uint32_t element, uint32_t instance) {
    trace::Intersection met;
    met.element = element;
    met.instance = instance;
    const Ray ray{Vec3::Zero(), Vec3::UnitX()};
    const uint32_t first = 0;
    float got = 0;
    evaluator.factors({&met, 1}, {&ray, 1}, {&first, 1}, {&got, 1});
    return double(got);
  };
  EXPECT_NEAR(factor(0, 0), 0.99, 1e-6);
  EXPECT_NEAR(factor(2, 0), 2.0 / 3 * 0.86, 1e-6);
  EXPECT_NEAR(factor(1, 1), 0.10, 1e-6);
  EXPECT_NEAR(factor(2, 1), 2.0 / 3 * 0.10, 1e-6);
  EXPECT_NEAR(factor(0, 2), 0.15 * radiometry::backscatter(m.named("asphalt").surface, 1), 1e-6);
}

TEST(Reflection, LeavesTiltWithTheirObject) {
  elements::Scene scene;
  elements::Model model;
  elements::Ellipsoid e;
  e.label = uint32_t(elements::Class::kGrass);
  model.ellipsoids.push_back(e);
  scene.models.push_back(model);
  scene.instances.resize(3);
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.6, Vec3(1, 2, 0).normalized()));
  scene.instances[1].world_from_model.rotation = tilt;
  scene.instances[2].world_from_model.rotation = Eigen::AngleAxisd(2, Vec3::UnitZ());
  elements::Mover mover;  // the first instance tips over within a second
  mover.instance = 0;
  mover.world_from_object = Trajectory({{0, {}}, {1, {tilt, Vec3::Zero()}}});
  radiometry::Materials m = all_of("leaf");
  for (radiometry::Material& material : m.material) material.leaf_shape = 5;  // flat
  const double rho = m.named("leaf").reflectance_at(905e-9);
  const LeafAngleDistribution flat(5);
  const Reflection reflection(m, 905e-9);
  const auto factors = [&](const DynamicWorld& s, const Vec3& axis, double time_s) {
    Reflection::Evaluator evaluator(reflection, s);
    std::vector<trace::Intersection> met(4);
    for (size_t k = 0; k < met.size(); ++k) met[k].element = 0, met[k].instance = uint32_t(k % 3);
    const std::vector<Ray> rays(4, Ray{Vec3::Zero(), axis});
    const std::vector<uint32_t> which{0, 1, 2, 3};
    std::vector<float> got(4);
    evaluator.begin(Vec3::UnitX(), 0.5);
    evaluator.factors(met, rays, which, got);
    evaluator.begin(axis, time_s);
    evaluator.factors(met, rays, which, got);
    return got;
  };
  const Vec3 axis = Vec3(0.5, -0.3, -0.8).normalized();
  const double level = rho * flat.backscatter(axis.z());
  const double tilted = rho * flat.backscatter((tilt * Vec3::UnitZ()).dot(axis));
  ASSERT_GT(std::abs(level - tilted), 0.02);
  const trace::World world(scene);
  const auto expect = [](const std::vector<float>& got, const std::array<double, 4>& want) {
    for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(double(got[k]), want[k], 1e-6) << k;
  };
  expect(factors(world, axis, 0), {level, tilted, level, level});
  const DynamicWorld moving(scene, {mover});
  expect(factors(moving, axis, 0), {level, tilted, level, level});
  expect(factors(moving, axis, 1), {tilted, tilted, level, tilted});
}

}  // namespace
}  // namespace underbrush::simulate
