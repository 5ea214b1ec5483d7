#include "underbrush/test_site/test_site.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "underbrush/core/parallel.hpp"
#include "underbrush/test_site/prototypes.hpp"

namespace underbrush::test_site {
namespace {

const Site& default_site() {
  static const Site site = make_site(SiteParameters{});
  return site;
}

const FlatSite& default_flat() {
  static const FlatSite flat = flatten(default_site());
  return flat;
}

bool is_tree(elements::Class c) { return c >= elements::Class::kSmallTree; }

TEST(Classes, HaveNamesThatReadBack) {
  for (size_t i = 0; i < elements::kClassNames.size(); ++i) {
    const auto c = elements::Class(i);
    EXPECT_EQ(elements::class_from_name(elements::name(c)), c);
  }
  EXPECT_EQ(elements::name(elements::Class::kLargeTree), "large_tree");
  EXPECT_FALSE(elements::class_from_name("tank"));
}

TEST(Site, HoldsWhatWasAskedFor) {
  const Site& site = default_site();
  int trees = 0, shrubs = 0;
  std::set<elements::Class> kinds;
  for (const Placement& p : site.placements) {
    kinds.insert(p.label);
    trees += is_tree(p.label);
    shrubs += !is_tree(p.label) && p.label != elements::Class::kGrass;
    const double height_m = p.scale * site.prototypes[p.prototype].height_m;
    if (is_tree(p.label)) {
      EXPECT_EQ(p.label, elements::tree_class(height_m));
      EXPECT_GT(height_m, 3.8);
      EXPECT_LT(height_m, 15.3);
    }
  }
  EXPECT_EQ(trees, site.parameters.trees);
  EXPECT_EQ(shrubs, site.parameters.shrubs);
  EXPECT_EQ(kinds.size(), 8u);
}

TEST(Site, NumbersItsInstancesFromOne) {
  const Site& site = default_site();
  for (size_t i = 0; i < site.placements.size(); ++i) {
    ASSERT_EQ(site.placements[i].instance, i + 1);
  }
}

TEST(FlatSite, IsAValidModelOfTheSizeStated) {
  const FlatSite& flat = default_flat();
  EXPECT_NO_THROW(flat.model.check());
  EXPECT_LE(flat.model.size(), 3'000'000u);
  EXPECT_EQ(flat.label.size(), flat.model.size());
  EXPECT_EQ(flat.instance.size(), flat.model.size());
  EXPECT_EQ(flat.part.size(), flat.model.size());
}

// No vertex of any plant is on the track, and no plant hovers: its foot is at or below the ground.
TEST(FlatSite, KeepsTheTrackFree) {
  const Site& site = default_site();
  const FlatSite& flat = default_flat();
  const auto& surface = flat.model.surface;
  double nearest = 1e9;
  for (size_t i = 0; i < surface.vertices.size(); i += 7) {
    const Vec3f& v = surface.vertices[i];
    nearest = std::min(nearest, site.terrain.distance_to_track(v.x(), v.y()));
  }
  EXPECT_GT(nearest, site.parameters.terrain.track_half_width_m);
  for (const Placement& p : site.placements) {
    const Vec3& at = p.world_from_plant.translation;
    EXPECT_LE(at.z(), site.terrain.height(at.x(), at.y()));
    EXPECT_GT(at.z(), site.terrain.height(at.x(), at.y()) - 0.2);
  }
}

TEST(FlatSite, LabelsEachTriangleByThePlantThatOwnsIt) {
  const Site& site = default_site();
  const FlatSite& flat = default_flat();
  const size_t ground = flat.model.ground.size();
  for (size_t i = 0; i < ground; i += 101) {
    ASSERT_EQ(flat.label[i], elements::Class::kGround);
    ASSERT_EQ(flat.instance[i], 0u);
    ASSERT_EQ(flat.part[i], Part::kGround);
  }
  std::map<uint32_t, size_t> count;
  for (size_t i = ground; i < flat.model.size(); ++i) ++count[flat.instance[i]];
  ASSERT_EQ(count.size(), site.placements.size());
  for (const Placement& p : site.placements) {
    EXPECT_EQ(count[p.instance], site.prototypes[p.prototype].plant.mesh.size());
  }
  for (size_t i = ground; i < flat.model.size(); i += 97) {
    const Placement& p = site.placements[flat.instance[i] - 1];
    ASSERT_EQ(flat.label[i], p.label);
    const auto& t = flat.model.surface.triangles[i - ground];
    const Vec3 from_foot =
        p.world_from_plant.inverse() * flat.model.surface.vertices[t[0]].cast<double>().eval();
    const Prototype& prototype = site.prototypes[p.prototype];
    ASSERT_LT(from_foot.z(), p.scale * prototype.height_m + 1e-4);
    ASSERT_LT(from_foot.head<2>().norm(), p.scale * prototype.radius_m + 1e-4);
  }
}

TEST(Site, HasTheSameBitsOnAnyNumberOfThreads) {
  SiteParameters p;
  p.seed = 9;
  set_threads(1);
  const FlatSite one = flatten(make_site(p));
  set_threads(2);
  const FlatSite two = flatten(make_site(p));
  set_threads(0);
  EXPECT_EQ(one.model.ground.vertices, two.model.ground.vertices);
  EXPECT_EQ(one.model.surface.vertices, two.model.surface.vertices);
  EXPECT_EQ(one.model.surface.triangles, two.model.surface.triangles);
  EXPECT_EQ(one.instance, two.instance);
  EXPECT_EQ(one.label, two.label);
  EXPECT_NE(one.model.surface.vertices, default_flat().model.surface.vertices);
}

TEST(Site, RefusesNegativeNumbers) {
  SiteParameters p;
  p.shrubs = -1;
  EXPECT_THROW(make_site(p), std::invalid_argument);
}

TEST(Prototypes, OfOtherSpeciesAreAsHighButNotAsWide) {
  const PrototypeSet own = make_prototypes(5), other = make_prototypes(5, 2);
  ASSERT_EQ(own.prototypes.size(), other.prototypes.size());
  size_t wider = 0, narrower = 0;
  for (uint32_t k = own.trees.begin; k < own.shrubs.end; ++k) {
    const Prototype &a = own.prototypes[k], &b = other.prototypes[k];
    EXPECT_NEAR(b.height_m, a.height_m, 0.1 * a.height_m) << a.name;
    EXPECT_GT(b.radius_m, 0.4 * a.radius_m) << a.name;
    EXPECT_LT(b.radius_m, 2.5 * a.radius_m) << a.name;
    wider += b.radius_m > 1.15 * a.radius_m;
    narrower += b.radius_m < 0.85 * a.radius_m;
  }
  EXPECT_GT(wider, 2u);
  EXPECT_GT(narrower, 2u);
  EXPECT_EQ(make_prototypes(5, 1).prototypes[0].plant.mesh.vertices,
            own.prototypes[0].plant.mesh.vertices);
  EXPECT_THROW(make_prototypes(5, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::test_site
