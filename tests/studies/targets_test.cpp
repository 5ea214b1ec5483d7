#include "studies/targets.hpp"

#include <gtest/gtest.h>

#include <map>

#include "underbrush/trace/world.hpp"

namespace underbrush::studies {
namespace {

/// Computes the share of parallel rays along +x through the middle metre of the target that end at
/// it.
double opacity(const StaticTarget& target) {
  elements::Model model;
  model.surface = target.geometry.mesh;
  const trace::World world(model);
  int hits = 0, rays = 0;
  for (double y = -0.3; y <= 0.3; y += 0.01) {
    for (double z = -0.8; z <= 0.8; z += 0.02) {
      const double up = target.centre_z_m + z * target.half_height_m;
      hits += !world.nearest_surface({{0, y, up}, Vec3::UnitX()}, {0, 50}).none();
      ++rays;
    }
  }
  return double(hits) / rays;
}

TEST(StaticTarget, LetsAsManyBeamsThroughAsItsNameSays) {
  std::map<std::string, double> share;
  for (const std::string& name : static_target_names()) {
    const StaticTarget t = static_target(name, 8, 1);
    EXPECT_EQ(t.name, name);
    EXPECT_EQ(t.porous, name != "planes");
    share[name] = opacity(t);
  }
  EXPECT_EQ(share["planes"], 1);
  EXPECT_GT(share["tree_high"], share["tree_medium"] + 0.05);
  EXPECT_GT(share["tree_medium"], share["tree_low"] + 0.05);
  EXPECT_GT(share["tree_low"], 0.1);
  EXPECT_GT(share["tall_grass"], 0.5);
}

TEST(StaticTarget, StandsWhereItIsAskedForAndIsTheSameForASeed) {
  for (const std::string& name : static_target_names()) {
    const StaticTarget a = static_target(name, 8, 3), b = static_target(name, 8, 3);
    EXPECT_EQ(a.geometry.mesh.vertices, b.geometry.mesh.vertices) << name;
    const auto box = test_site::bounds(a.geometry.mesh);
    EXPECT_GT(box.min().x(), 5) << name;
    EXPECT_LT(box.max().x(), 11) << name;
  }
  EXPECT_THROW(static_target("pond", 8, 1), std::invalid_argument);
  EXPECT_THROW(static_target("planes", 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::studies
