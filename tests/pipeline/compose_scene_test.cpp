#include "underbrush/pipeline/compose_scene.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "primitives/sites.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::pipeline {
namespace {

using primitives::PlacedObject;

/// Two trees of different heights as primitives, and a site of one object as high as the second.
class ComposeScene : public testing::Test {
 protected:
  ComposeScene() {
    std::vector<primitives::Primitive> trees(2);
    for (size_t k = 0; k < trees.size(); ++k) {
      const double height = k == 0 ? 3 : 5;
      trees[k].label = elements::Class::kSmallTree;
      trees[k].box = {Vec3(-1, -1, 0), Vec3(1, 1, height)};
      trees[k].model.ellipsoids.emplace_back();
      trees[k].model.ellipsoids[0].mean = Vec3f(0, 0, float(height) / 2);
      trees[k].model.max_range_m = 50;
    }
    set = primitives::primitive_set(std::move(trees), 2);
    PlacedObject o;
    o.label = elements::Class::kSmallTree;
    o.position = Vec3(3, 4, 0);
    o.box = {Vec3(-1, -1, 0), Vec3(1, 1, 5)};
    site.objects.push_back(o);
    ground.origin = Vec3::Zero();
  }

  primitives::PrimitiveSet set;
  primitives::Annotation site;
  elements::Model ground = test::plane(40, 0, 0);
};

TEST_F(ComposeScene, OfValuesIsTheOneOfFiles) {
  const io::TemporaryFolder folder;
  site.ground = folder / "ground";  // It is not read, as the ground is given.
  primitives::write_annotation(folder / "site.json", site);
  ComposeOptions options;
  options.choose = "box";
  options.class_density = {"small_tree=3"};
  const primitives::Composition values = compose_scene(site, ground, set, options);
  const ComposedScene files =
      compose_scene(folder / "site.json", {"set", set}, &ground, "", options);
  ASSERT_EQ(values.scene.instances.size(), files.composition.scene.instances.size());
  EXPECT_EQ(values.placed, 3u);
  for (size_t k = 0; k < values.scene.instances.size(); ++k) {
    EXPECT_EQ(values.scene.instances[k].world_from_model.translation,
              files.composition.scene.instances[k].world_from_model.translation);
    EXPECT_EQ(values.scene.instances[k].model, files.composition.scene.instances[k].model);
  }
}

TEST_F(ComposeScene, OfValuesChecksItsOptionsAndItsGround) {
  ComposeOptions options;
  options.choose = "worst";
  EXPECT_THROW(compose_scene(site, ground, set, options), std::invalid_argument);
  EXPECT_THROW(compose_scene(site, elements::Model(), set, {}), DataError);
}

}  // namespace
}  // namespace underbrush::pipeline
