#include "underbrush/plant_meshes/mesh_primitives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "io/temporary.hpp"
#include "primitives/sites.hpp"
#include "underbrush/primitives/compose.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::plant_meshes {
namespace {

using namespace primitives;

using elements::Class;

/// Makes a four-sided pyramid of 2a × 2b × height, beside the origin and rotated by `yaw`.
PlantSource pyramid(double a, double b, double height, double yaw) {
  PlantSource p{"pyramid", {}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  const double c = std::cos(yaw), s = std::sin(yaw);
  for (const auto& [x, y] : {std::pair{a, b}, {-a, b}, {-a, -b}, {a, -b}}) {
    p.vertices.emplace_back(float(7 + c * x - s * y), float(-3 + s * x + c * y), 100.f);
  }
  p.vertices.emplace_back(7.f, -3.f, float(100 + height));
  return p;
}

TEST(MeshPrimitives, StandOnTheirFeetAlongTheirLongerAxis) {
  PlantSource plant = pyramid(2, 1, 4, 0.6);
  plant.label = Class::kMediumTree;  // keeps its size, whatever its height
  const auto set = mesh_primitives({plant});
  ASSERT_EQ(set.size(), 1u);
  EXPECT_EQ(set[0].label, Class::kMediumTree);
  EXPECT_LT((set[0].box.min - Vec3(-2, -1, 0)).norm(), 1e-4);
  EXPECT_LT((set[0].box.max - Vec3(2, 1, 4)).norm(), 1e-4);
}

TEST(MeshPrimitives, FillEveryClassWithPlantsOfItsHeight) {
  const auto set = mesh_primitives({pyramid(1, 1, 8, 0), pyramid(0.5, 0.4, 1, 0.3)});
  std::map<Class, size_t> count;
  const SizeRules rules;
  for (const Primitive& p : set) {
    ++count[p.label];
    EXPECT_NO_THROW(p.model.check());
    EXPECT_NEAR(p.box.min.z(), 0, 1e-6);
    double top = 0;
    for (const Vec3f& v : p.model.surface.vertices) top = std::max(top, double(v.z()));
    EXPECT_NEAR(top, p.box.max.z(), 1e-4);
    const bool tree = elements::kind_of(p.label) == elements::ClassKind::kTree;
    const bool patch = elements::kind_of(p.label) == elements::ClassKind::kPatch;
    EXPECT_EQ(p.label, tree ? tree_class(rules, top) : shrub_class(rules, top, patch));
    EXPECT_EQ(p.model.surface.range_sigma_m, 0.02);
    for (const auto& hit : p.model.surface.hit) EXPECT_EQ(hit.p, 1);
    const double slim = p.box.size().x() / p.box.size().z();
    EXPECT_NEAR(patch ? p.box.size().x() : tree ? slim : 1, patch ? 2 : tree ? 0.25 : 1, 1e-4);
  }
  EXPECT_EQ(count.size(), 11u);
}

TEST(MeshPrimitives, AreScaledOnlySoFar) {
  const auto set = mesh_primitives({pyramid(1, 1, 4, 0), pyramid(1, 1, 12, 0)});
  for (const Primitive& p : set) {
    const double h = p.box.size().z(), slim = h / p.box.size().x();
    const double own = slim < 3 ? 4 : 12;
    EXPECT_LE(std::max(h / own, own / h), 2 + 1e-6);
  }
  // A single plant must serve all classes.
  EXPECT_EQ(mesh_primitives({pyramid(1, 1, 4, 0)}).size(), 9u);
}

TEST(MeshPrimitives, AreTheSameForTheSameSeed) {
  const std::vector<PlantSource> plants{pyramid(0.2, 0.2, 0.6, 0), pyramid(0.3, 0.2, 1.5, 0)};
  MeshPrimitiveOptions o;
  const auto a = mesh_primitives(plants, o), b = mesh_primitives(plants, o);
  o.seed = 2;
  const auto c = mesh_primitives(plants, o);
  ASSERT_EQ(a.size(), b.size());
  bool differs = false;
  for (size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].model.surface.vertices, b[k].model.surface.vertices);
    differs |= a[k].model.surface.vertices != c[k].model.surface.vertices;
  }
  EXPECT_TRUE(differs);
}

TEST(MeshPrimitives, AreComposedAndHitLikeAnyOther) {
  PlantSource plant = pyramid(2, 2, 4, 0);
  plant.label = Class::kSmallTree;
  const io::TemporaryFolder folder;
  write_primitives(folder / "set", mesh_primitives({plant}), 2, "");
  const elements::Model ground = test::plane(40, 0, 0);
  Annotation site;
  site.objects.emplace_back();
  site.objects[0].label = Class::kSmallTree;
  site.objects[0].position = Vec3(5, -15, 0);
  site.objects[0].box = {Vec3(-2, -2, 0), Vec3(2, 2, 4)};
  const Composition c = compose(site, ground, read_primitive_set(folder / "set"), {});
  ASSERT_EQ(c.placed, 1u);
  const trace::World world(c.scene);
  // At 2 m above the ground (z = 3) the pyramid reaches 1 m about its axis.
  const trace::Intersection met =
      world.nearest_accepted({Vec3(-5, -15, 5), Vec3(1, 0, 0)}, 1, {0, 100});
  ASSERT_GT(met.instance, 0u);
  EXPECT_NEAR(met.t_m, 9, 1e-3);
}

// A set in memory gives the same scene as its folder, to the bit.
TEST(MeshPrimitives, InMemoryAreThoseOfTheFolder) {
  const std::vector<Primitive> set =
      mesh_primitives({pyramid(1.2345678, 1, 8, 0.2), pyramid(0.5, 0.4321, 1, 0.3)});
  const io::TemporaryFolder folder;
  write_primitives(folder / "set", set, 1.5, "");
  const PrimitiveSet held = primitive_set(set, 1.5), read = read_primitive_set(folder / "set");
  EXPECT_EQ(held.cell_m, read.cell_m);
  const elements::Model ground = test::plane(40, 0, 0);
  Annotation site;
  for (int k = 0; k < 6; ++k) {
    site.objects.emplace_back();
    site.objects[k].label = k % 2 ? Class::kMediumTree : Class::kSmallShrub;
    site.objects[k].position = Vec3(4 * k, -15, 0);
    site.objects[k].yaw_rad = 0.3 * k;
    site.objects[k].box = {Vec3(-1, -1, 0), Vec3(1, 1, 0.5 + k)};
  }
  const Composition a = compose(site, ground, held, {}), b = compose(site, ground, read, {});
  ASSERT_EQ(a.placed, 6u);
  EXPECT_EQ(a.info.names, b.info.names);
  EXPECT_EQ(a.mean_box_distance_m, b.mean_box_distance_m);
  ASSERT_EQ(a.scene.instances.size(), b.scene.instances.size());
  for (size_t k = 0; k < a.scene.instances.size(); ++k) {
    const auto &one = a.scene.instances[k], &two = b.scene.instances[k];
    EXPECT_EQ(one.world_from_model.translation, two.world_from_model.translation);
    EXPECT_EQ(one.world_from_model.rotation.coeffs(), two.world_from_model.rotation.coeffs());
    EXPECT_EQ(one.model, two.model);
  }
  for (size_t k = 0; k < a.scene.models.size(); ++k) {
    EXPECT_EQ(a.scene.models[k].surface.vertices, b.scene.models[k].surface.vertices);
    EXPECT_EQ(a.scene.models[k].surface.triangles, b.scene.models[k].surface.triangles);
    EXPECT_EQ(a.scene.models[k].surface.range_sigma_m, b.scene.models[k].surface.range_sigma_m);
  }
}

TEST(MeshPrimitives, RefusePlantsWithoutExtent) {
  EXPECT_THROW(mesh_primitives({PlantSource{"none", {}, {}}}), std::invalid_argument);
  PlantSource flat = pyramid(1, 1, 0, 0);
  EXPECT_THROW(mesh_primitives({flat}), std::invalid_argument);
  EXPECT_TRUE(mesh_primitives({}).empty());
}

}  // namespace
}  // namespace underbrush::plant_meshes
