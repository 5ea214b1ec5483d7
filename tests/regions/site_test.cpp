// Tests of sites in parts, and of worlds that are composed of them.
#include <gtest/gtest.h>

#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/primitives/annotation.hpp"
#include "underbrush/regions/compose_world.hpp"
#include "underbrush/regions/world_folder.hpp"

namespace underbrush::regions {
namespace {

using elements::Class;
using primitives::PlacedObject;

/// A fixture with a site of 110 m × 70 m in parts of 20 m.
class Sites : public testing::Test {
 protected:
  Sites() {
    terrain.size_x_m = 110;
    terrain.size_y_m = 70;
    options.kind = "forest";
    options.seed = 5;
    generated = generate_site(folder / "site", terrain, 2, 0.03, options, 20, "{}");
    Stream random(1);
    std::vector<primitives::Primitive> all;
    for (int k = 0; k < 30; ++k) {
      primitives::Primitive p;
      p.label = k < 20 ? Class::kMediumTree : k < 25 ? Class::kSmallShrub : Class::kLowShrubPatch;
      for (int d = 0; d < 3; ++d) p.box.max[d] = random.uniform(1, 12);
      p.model.ellipsoids.emplace_back();
      all.push_back(p);
    }
    set = primitives::primitive_set(std::move(all), 2);
  }

  /// The objects of all parts, in the order of the parts.
  std::vector<PlacedObject> objects() const {
    std::vector<PlacedObject> out;
    for (const SitePart& part : read_site(folder / "site").parts) {
      const auto read = primitives::read_annotation(part.annotation);
      for (const PlacedObject& o : read.objects) EXPECT_GE(o.position.y(), part.south_m - 0.001);
      out.insert(out.end(), read.objects.begin(), read.objects.end());
    }
    return out;
  }

  io::TemporaryFolder folder;
  test_site::TerrainParameters terrain;
  sites::GenerateOptions options;
  GeneratedSite generated;
  primitives::PrimitiveSet set;
};

TEST_F(Sites, PartsHaveTheDensityOfTheWhole) {
  EXPECT_EQ(generated.parts, 24u);
  EXPECT_EQ(generated.triangles, 2u * 55 * 35);
  size_t all = 0, trees = 0, patches = 0;
  for (const PlacedObject& o : objects()) {
    ++all;
    trees += elements::kind_of(o.label) == elements::ClassKind::kTree;
    patches += elements::kind_of(o.label) == elements::ClassKind::kPatch;
    EXPECT_LE(std::abs(o.position.x()), 55.001);
    EXPECT_LE(std::abs(o.position.y()), 35.001);
  }
  size_t counted = 0;
  for (const auto& [label, n] : generated.objects) counted += n;
  EXPECT_EQ(all, counted);
  EXPECT_NEAR(double(trees), 0.05 * 110 * 70, 24 * 0.5);
  // Patches are those of the same site in one piece, whose field and cells are the same.
  elements::Model ground;
  ground.ground = test_site::Terrain(terrain, options.seed).mesh(2, 0);
  size_t of_whole = 0;
  for (const PlacedObject& o :
       sites::generate_objects(primitives::GroundSurface(ground), options).objects) {
    of_whole += elements::kind_of(o.label) == elements::ClassKind::kPatch;
  }
  EXPECT_GT(patches, 0u);
  EXPECT_EQ(patches, of_whole);
}

TEST_F(Sites, WithOtherCountsOfPartsThanTheManifestSaysAreRefused) {
  const std::filesystem::path file = folder / "site" / "site.json";
  const std::string text = read_file(file);
  const size_t parts = read_site(folder / "site").parts.size();
  const size_t columns = 6;
  const size_t at = text.find("\"columns\": 6");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(parts % columns, 0u);
  for (const char* wrong : {"0", "1", "5", "7"}) {
    std::ofstream(file) << std::string(text).replace(at + 11, 1, wrong);
    EXPECT_THROW(read_site(folder / "site"), FormatError) << wrong;
  }
  std::ofstream(file) << text;
  EXPECT_EQ(read_site(folder / "site").parts.size(), parts);
}

TEST_F(Sites, TreesKeepApartAcrossTheBordersOfParts) {
  std::vector<PlacedObject> trees;
  for (const PlacedObject& o : objects()) {
    if (elements::kind_of(o.label) == elements::ClassKind::kTree) trees.push_back(o);
  }
  for (size_t a = 0; a < trees.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      const double apart = (trees[a].position - trees[b].position).head<2>().norm();
      const double widths = trees[a].box.size().x() + trees[b].box.size().x();
      ASSERT_GT(apart, 0.44 * widths - 0.01);
    }
  }
}

TEST_F(Sites, AWorldOfPartsIsTheSceneOfAllOfThem) {
  primitives::ComposeOptions to_compose;
  to_compose.nearest = 3;
  const auto composed =
      compose_world(folder / "world", read_site(folder / "site"), set, to_compose, false, "{}");
  const WorldPart world = WorldFolder(folder / "world").whole();
  primitives::Annotation all;
  all.objects = objects();
  elements::Model ground;
  ground.ground = test_site::Terrain(terrain, options.seed).mesh(2, 0);
  const primitives::Composition expected = primitives::compose(all, ground, set, to_compose);
  EXPECT_EQ(composed.placed, expected.placed);
  EXPECT_EQ(composed.objects, all.objects.size());
  EXPECT_NEAR(composed.mean_box_distance_m, expected.mean_box_distance_m, 1e-12);
  EXPECT_EQ(world.scene.models[0].ground.size(), ground.ground.size());
  EXPECT_EQ(world.info.labels, expected.info.labels);
  ASSERT_EQ(world.scene.instances.size(), expected.scene.instances.size());
  for (size_t k = 0; k < world.scene.instances.size(); ++k) {
    const elements::Instance &a = world.scene.instances[k], &b = expected.scene.instances[k];
    ASSERT_EQ(a.model, b.model);
    ASSERT_EQ(a.world_from_model.translation, b.world_from_model.translation);
    ASSERT_EQ(a.world_from_model.rotation.coeffs(), b.world_from_model.rotation.coeffs());
  }
  to_compose.density[Class::kMediumTree] = 2;
  EXPECT_THROW(
      compose_world(folder / "other", read_site(folder / "site"), set, to_compose, false, "{}"),
      std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(folder / "other"));
}

}  // namespace
}  // namespace underbrush::regions
