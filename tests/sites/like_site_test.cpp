#include "underbrush/sites/like_site.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "primitives/sites.hpp"
#include "underbrush/sites/generate.hpp"

namespace underbrush::sites {
namespace {

using elements::Class;
using elements::ClassKind;
using primitives::GroundSurface;
using primitives::PlacedObject;

/// A generated site as the site that others shall be like.
class LikeSite : public testing::Test {
 protected:
  LikeSite() : ground_model(test::plane(50, 0.05, 0)), ground(ground_model) {
    GenerateOptions o;
    o.kind = "savanna";
    o.density = 0.01;
    objects = generate_objects(ground, o).objects;
    model.emplace(fit_site(ground, objects, 2, 1));
  }
  elements::Model ground_model;
  GroundSurface ground;
  std::vector<PlacedObject> objects;
  std::optional<SiteModel> model;
};

TEST_F(LikeSite, HasItsStatistics) {
  size_t rows = 0;
  for (const ComparedStatistic& s : compare_with_draws(*model, ground_model, objects, 12, 3)) {
    if (std::isnan(s.site.value) || s.site.name.starts_with("ground")) continue;
    ++rows;
    // Twice the interval, so that all hold at once; the deviation is known from 12 draws only.
    const double reach = std::max(s.high - s.low, 0.02 * std::abs(s.mean));
    EXPECT_NEAR(s.site.value, s.mean, reach) << s.site.name;
    EXPECT_LT(s.low, s.high + 1e-9) << s.site.name;
  }
  EXPECT_GE(rows, 15u);
}

TEST_F(LikeSite, IsAsDenseOnAnyGround) {
  const elements::Model wide = test::plane(120, 0, 0.1);
  const GroundSurface other(wide);
  const DrawnSite drawn = draw_site(*model, other, {});
  const auto count = [](const std::vector<PlacedObject>& all, ClassKind kind) {
    return double(std::count_if(all.begin(), all.end(), [&](const PlacedObject& o) {
      return elements::kind_of(o.label) == kind;
    }));
  };
  const double factor = 240.0 * 240 / 1e4;
  for (const ClassKind kind : {ClassKind::kTree, ClassKind::kShrub, ClassKind::kPatch}) {
    const double wanted = factor * count(objects, kind);
    EXPECT_NEAR(count(drawn.objects, kind), wanted, 0.15 * wanted) << int(kind);
  }
  std::set<std::pair<double, double>> cells;
  for (const PlacedObject& o : drawn.objects) {
    ASSERT_NEAR(o.position.z(), other.at(o.position.x(), o.position.y()).value(), 1e-9);
    if (elements::kind_of(o.label) != ClassKind::kPatch) continue;
    EXPECT_NEAR(std::remainder(o.position.x() - 1, 2), 0, 1e-9);  // on the grid of cells
    EXPECT_TRUE(cells.emplace(o.position.x(), o.position.y()).second);
  }
}

TEST_F(LikeSite, TakesWholeObjectsOfTheSite) {
  for (size_t k = 0; k < objects.size(); ++k) {
    objects[k].layers.z.fill(double(k + 1));
  }
  model.emplace(fit_site(ground, objects, 2, 1));
  std::set<double> used;
  for (const PlacedObject& o : draw_site(*model, ground, {}).objects) {
    const auto k = size_t(o.layers.z[0]) - 1;
    EXPECT_EQ(o.label, objects.at(k).label);
    EXPECT_EQ(o.box.size(), objects[k].box.size());
    used.insert(o.layers.z[0]);
  }
  EXPECT_GT(used.size(), objects.size() / 3);
}

TEST_F(LikeSite, HasNoClassThatIsNotAllowed) {
  DrawOptions options;
  options.classes = {Class::kSmallTree, Class::kMediumShrub};
  const DrawnSite drawn = draw_site(*model, ground, options);
  size_t trees = 0, all_trees = 0;
  for (const PlacedObject& o : drawn.objects) {
    ASSERT_TRUE(is_allowed(options.classes, o.label));
    trees += o.label == Class::kSmallTree;
  }
  for (const PlacedObject& o : objects) all_trees += elements::kind_of(o.label) == ClassKind::kTree;
  EXPECT_NEAR(double(trees), double(all_trees), 6);
  EXPECT_TRUE(drawn.replaced.count("medium_tree"));
  EXPECT_TRUE(drawn.left_out.count("small_shrub_patch"));
  EXPECT_EQ(drawn.missing_cells, 0u);
}

TEST_F(LikeSite, DependsOnTheSeedAlone) {
  const DrawnSite a = draw_site(*model, ground, {}), b = draw_site(*model, ground, {});
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (size_t k = 0; k < a.objects.size(); ++k) {
    EXPECT_EQ(a.objects[k].position, b.objects[k].position);
  }
  DrawOptions other;
  other.seed = 2;
  EXPECT_NE(draw_site(*model, ground, other).objects[0].position, a.objects[0].position);
}

TEST_F(LikeSite, NeedsObjects) {
  objects.resize(5);
  EXPECT_THROW(fit_site(ground, objects, 2, 1), DataError);
  EXPECT_THROW(fit_site(ground, {}, 2, 1), DataError);
}

TEST(GroundLike, HasTheNoiseAndNoPlaceOfTheSite) {
  elements::Model site = test::plane(40, 0.1, 0);
  site.ground.range_sigma_m = 0.04;
  site.ground.roughness = {0.01f, 0.03f};
  site.ground.hit[0].p = 0.8f;
  site.ground.hit[1].p = 0.6f;
  const elements::Model like = ground_like(site, {30, 20}, 1, 1);
  EXPECT_EQ(like.origin, Vec3::Zero());
  EXPECT_EQ(like.ground.range_sigma_m, 0.04);
  EXPECT_NEAR(like.ground.roughness_m, 0.02, 1e-9);
  EXPECT_NEAR(like.ground.hit[5].p, 0.7f, 1e-6);
  EXPECT_EQ(like.ground.size(), 2u * 30 * 20);
  EXPECT_NO_THROW(like.check());
  const GroundSurface surface(like);
  EXPECT_NEAR(surface.at(10, 0).value() - surface.at(-10, 0).value(), 2, 0.1);
}

}  // namespace
}  // namespace underbrush::sites
