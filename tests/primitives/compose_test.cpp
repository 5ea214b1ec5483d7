#include "underbrush/primitives/compose.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "io/temporary.hpp"
#include "primitives/layers.hpp"
#include "primitives/sites.hpp"

namespace underbrush::primitives {
namespace {

using elements::Class;

/// A fixture with primitives of one ellipsoid each, whose label is the primitive's number.
class Composing : public testing::Test {
 protected:
  Composing() {
    Stream random(1);
    for (uint32_t k = 0; k < 40; ++k) {
      Primitive p;
      p.label = k < 15   ? Class::kSmallTree
                : k < 25 ? Class::kLargeTree
                : k < 30 ? Class::kLowShrub
                         : Class::kMediumShrubPatch;
      for (int d = 0; d < 3; ++d) p.box.max[d] = random.uniform(0.5, 4);
      p.box.min = Vec3(-p.box.max.x(), -0.5, 0);
      if (k >= 30) p.box = {Vec3(-1, -1, 0), Vec3(1, 1, p.box.max.z())};
      p.model.ellipsoids.emplace_back();
      p.model.ellipsoids[0].label = k;
      p.model.max_range_m = 80;
      primitives.push_back(p);
    }
    write_primitives(folder / "set", primitives, 2, "");
    set = read_primitive_set(folder / "set");
    for (uint32_t k = 0; k < 300; ++k) {
      PlacedObject o;
      o.label = k % 2 ? Class::kSmallTree : Class::kLargeTree;
      o.position =
          Vec3(10 + random.uniform(-30, 30), -20 + random.uniform(-30, 30), random.uniform(-9, 9));
      o.yaw_rad = random.uniform(-3, 3);
      for (int d = 0; d < 3; ++d) o.box.max[d] = random.uniform(0.5, 6);
      annotation.objects.push_back(o);
    }
  }
  // Gives the number of the primitive that an instance is made of.
  uint32_t number(const Composition& c, size_t instance) const {
    return c.scene.models[c.scene.instances[instance].model].ellipsoids.at(0).label;
  }

  io::TemporaryFolder folder;
  std::vector<Primitive> primitives;
  PrimitiveSet set;
  Annotation annotation;
  elements::Model ground = test::plane(40, 0.2, -0.1);
};

TEST_F(Composing, AnObjectWithATrajectoryMovesFromWhereItWouldStand) {
  PlacedObject& o = annotation.objects[3];
  const Composition still = compose(annotation, ground, set, {});
  o.trajectory = folder / "poses.txt";
  // The foot starts where compose puts it, and is 2 m further along x after a second.
  const Pose foot = o.world_from_object();
  const double z = still.scene.instances[4].world_from_model.translation.z();  // boxes begin at 0
  std::ofstream poses(o.trajectory);
  poses.precision(17);
  const auto& q = foot.rotation.coeffs();
  for (int t = 0; t < 2; ++t) {
    poses << t << " " << o.position.x() + 2 * t << " " << o.position.y() << " " << z << " " << q[0]
          << " " << q[1] << " " << q[2] << " " << q[3] << "\n";
  }
  poses.close();
  const Composition c = compose(annotation, ground, set, {});
  ASSERT_EQ(c.info.movers.size(), 1u);
  EXPECT_EQ(c.info.movers[0].instance, 4u);
  const auto& path = c.info.movers[0].world_from_object.poses();
  const Pose& stands = c.scene.instances[4].world_from_model;
  EXPECT_LT((path[0].world_from_sensor.translation - stands.translation).norm(), 1e-6);
  EXPECT_LT((path[1].world_from_sensor.translation - stands.translation - Vec3(2, 0, 0)).norm(),
            1e-6);
}

TEST_F(Composing, TakesThePrimitiveOfTheClassWithTheNearestBox) {
  ComposeOptions options;
  options.choose = Choice::kBox;
  const Composition c = compose(annotation, ground, set, options);
  ASSERT_EQ(c.placed, 300u);
  ASSERT_EQ(c.scene.instances.size(), 301u);
  EXPECT_TRUE(c.borrowed.empty());
  for (size_t k = 0; k < 300; ++k) {
    const PlacedObject& o = annotation.objects[k];
    const uint32_t chosen = number(c, k + 1);
    EXPECT_EQ(primitives[chosen].label, o.label);
    EXPECT_EQ(c.info.labels[k + 1], o.label);
    for (const Primitive& p : primitives) {
      if (p.label != o.label) continue;
      EXPECT_LE((primitives[chosen].box.size() - o.box.size()).norm(),
                (p.box.size() - o.box.size()).norm() + 2e-3);
    }
  }
}

TEST_F(Composing, BoxesStandUponBoxesWithTheirBottomsOnTheGround) {
  const GroundSurface surface(ground);
  for (const bool scale : {false, true}) {
    ComposeOptions options;
    options.scale = scale;
    const Composition c = compose(annotation, ground, set, options);
    for (size_t k = 0; k < 300; ++k) {
      const PlacedObject& o = annotation.objects[k];
      const elements::Instance& i = c.scene.instances[k + 1];
      const Box& box = primitives[number(c, k + 1)].box;
      const auto world = [&](const Vec3& p) {
        return i.world_from_model * Vec3(double(i.scale) * p);
      };
      const Vec3 middle =
          world(Vec3(0.5 * (box.min.x() + box.max.x()), 0.5 * (box.min.y() + box.max.y()), 0));
      const Vec3 wanted = o.world_from_object() * (0.5 * (o.box.min + o.box.max));
      EXPECT_LT((middle - wanted).head<2>().norm(), 2e-3);
      EXPECT_NEAR(middle.z(), surface.at(o.position.x(), o.position.y()).value(), 1e-6);
      const Vec3 along = world(Vec3::UnitX()) - world(Vec3::Zero());
      EXPECT_NEAR(std::cos(std::atan2(along.y(), along.x()) - o.yaw_rad), 1, 1e-6);
      if (scale) {  // no other factor brings the boxes nearer together
        const double s = double(i.scale);
        for (const double other : {0.98 * s, 1.02 * s}) {
          EXPECT_LT((s * box.size() - o.box.size()).norm(),
                    (other * box.size() - o.box.size()).norm() + 1e-3);
        }
      }
    }
  }
}

TEST_F(Composing, InstancesShareTheirModels) {
  const Composition c = compose(annotation, ground, set, {});
  EXPECT_LE(c.scene.models.size(), 26u);
  EXPECT_EQ(c.scene.models[0].ground.size(), ground.ground.size());
  EXPECT_EQ(c.scene.models[0].max_range_m, 80);  // the range limit of the primitives' sensor
  EXPECT_NO_THROW(c.scene.check());
  EXPECT_EQ(c.info.names.size(), c.scene.models.size());
}

TEST_F(Composing, DrawsAmongTheNearest) {
  ComposeOptions options;
  options.choose = Choice::kBox;
  options.nearest = 3;
  const Composition a = compose(annotation, ground, set, options);
  const Composition b = compose(annotation, ground, set, options);
  options.seed = 2;
  const Composition other = compose(annotation, ground, set, options);
  size_t ranks[3] = {0, 0, 0}, changed = 0;
  for (size_t k = 0; k < 300; ++k) {
    EXPECT_EQ(number(a, k + 1), number(b, k + 1));
    changed += number(a, k + 1) != number(other, k + 1);
    const PlacedObject& o = annotation.objects[k];
    const auto distance = [&](const Primitive& p) { return (p.box.size() - o.box.size()).norm(); };
    const Primitive& chosen = primitives[number(a, k + 1)];
    const auto nearer =
        size_t(std::count_if(primitives.begin(), primitives.end(), [&](const Primitive& p) {
          return p.label == o.label && distance(p) < distance(chosen) - 1e-9;
        }));
    ASSERT_LT(nearer, 3u);
    ++ranks[nearer];
  }
  for (const size_t n : ranks) EXPECT_NEAR(double(n), 100, 40);
  EXPECT_GT(changed, 100u);
}

TEST_F(Composing, TheBestChoiceLooksAtWhereThePointsLie) {
  for (size_t k = 0; k < set.entries.size(); ++k) {  // boxes say nothing
    set.entries[k].box = {Vec3(-1, -1, 0), Vec3(1, 1, 3)};
    set.entries[k].layers = layers_at(Vec3(0, 0, 0.07 * double(k + 1)));
  }
  ComposeOptions options;
  options.choose = Choice::kBest;
  for (size_t k = 0; k < annotation.objects.size(); ++k) {
    PlacedObject& o = annotation.objects[k];
    o.box = set.entries[0].box;
    o.layers = layers_at(Vec3(0, 0, 0.07 * double(k % 25 + 1)));
    o.label = k % 25 < 15 ? Class::kSmallTree : Class::kLargeTree;
  }
  annotation.objects.resize(25);  // one that fits each tree
  const Composition c = compose(annotation, ground, set, options);
  for (size_t k = 0; k < 25; ++k) EXPECT_EQ(number(c, k + 1), k);
  // The points count from the foot of the box, wherever that is in the object's frame.
  for (size_t k = 0; k < 25; ++k) {
    const Vec3 aside(5, -4, 0.5);
    PlacedObject& o = annotation.objects[k];
    o.box = {o.box.min + aside, o.box.max + aside};
    o.layers = layers_at(Vec3(0, 0, 0.07 * double(k + 1)) + aside);
  }
  const Composition moved = compose(annotation, ground, set, options);
  for (size_t k = 0; k < 25; ++k) EXPECT_EQ(number(moved, k + 1), k);
  // Where the points are not known, the box decides.
  for (PlacedObject& o : annotation.objects) o.layers = {};
  EXPECT_EQ(number(compose(annotation, ground, set, options), 1), 0u);
}

TEST_F(Composing, TheBestChoiceMovesElementsToWhereThePointsOfTheObjectLie) {
  for (PrimitiveEntry& e : set.entries) e.layers = layers_at(0.5 * (e.box.min + e.box.max));
  annotation.objects.resize(60);
  for (size_t k = 0; k < 60; ++k) {  // 20 objects, three times
    PlacedObject& o = annotation.objects[k];
    if (k >= 20) {
      o.label = annotation.objects[k % 20].label;
      o.box = annotation.objects[k % 20].box;
    }
    o.layers = layers_at(0.5 * (o.box.min + o.box.max));
    o.position = Vec3(10 + 7 * double(k / 20 % 2), -20 + 7 * double(k / 40), 0);
  }
  ComposeOptions options;
  options.nearest = 1;
  const GroundSurface surface(ground);
  const Composition c = compose(annotation, ground, set, options);
  ASSERT_EQ(c.placed, 60u);
  for (size_t k = 0; k < 60; ++k) {
    const PlacedObject& o = annotation.objects[k];
    const elements::Instance& i = c.scene.instances[k + 1];
    // The ellipsoid at the foot of the primitive comes to the foot of the object's box.
    Vec3 foot = i.world_from_model * c.scene.models[i.model].ellipsoids.at(0).mean.cast<double>();
    foot = o.world_from_object().inverse() * foot;
    EXPECT_GT(foot.x(), o.box.min.x() - 1e-3);
    EXPECT_LT(foot.x(), o.box.max.x() + 1e-3);
    EXPECT_NEAR(i.world_from_model.translation.z(),
                surface.at(o.position.x(), o.position.y()).value(), 1e-6);
  }
  EXPECT_LE(c.scene.models.size(), 1 + 3 * 20u);
  for (const bool box : {true, false}) {  // Primitives stay as they are.
    options.choose = box ? Choice::kBox : Choice::kBest;
    options.scale = !box;
    const Composition plain = compose(annotation, ground, set, options);
    for (size_t k = 1; k < plain.scene.models.size(); ++k) {
      EXPECT_EQ(plain.scene.models[k].ellipsoids.at(0).mean, Vec3f::Zero());
    }
  }
}

TEST_F(Composing, TheBestChoiceRepeatsNoPlantNearbyIfOthersFit) {
  for (PrimitiveEntry& e : set.entries) e.box = set.entries[0].box;  // all fit
  annotation.objects.resize(15);
  for (size_t k = 0; k < 15; ++k) {
    annotation.objects[k].label = Class::kSmallTree;
    annotation.objects[k].box = set.entries[0].box;
    annotation.objects[k].position = Vec3(10 + double(k), -20, 0);
  }
  const auto plants = [&](Choice choose) {
    ComposeOptions options;
    options.choose = choose;
    const Composition c = compose(annotation, ground, set, options);
    std::set<uint32_t> out;
    for (size_t k = 1; k < c.scene.instances.size(); ++k) out.insert(number(c, k));
    return out.size();
  };
  EXPECT_EQ(plants(Choice::kBox), 1u);
  EXPECT_EQ(plants(Choice::kBest), 15u);
  set.entries[0].box.max.z() += 3 * Chooser::kFitsM;  // one fits worse than a repeated plant
  EXPECT_EQ(plants(Choice::kBest), 14u);
  for (size_t k = 0; k < 15; ++k) {
    annotation.objects[k].position =
        Vec3(-10 + 21 * double(k % 3), -50 + 21 * double(k / 3 % 3), 0);
  }
  EXPECT_LT(plants(Choice::kBest), 14u);  // farther apart, the best ones come again
}

TEST_F(Composing, ARandomChoiceTakesAnyPrimitiveOfTheClass) {
  ComposeOptions options;
  options.choose = Choice::kRandom;
  const Composition c = compose(annotation, ground, set, options);
  std::map<uint32_t, size_t> times;
  for (size_t k = 0; k < 300; ++k) {
    ++times[number(c, k + 1)];
    EXPECT_EQ(primitives[number(c, k + 1)].label, annotation.objects[k].label);
  }
  EXPECT_EQ(times.size(), 25u);
  for (const auto& [primitive, n] : times) EXPECT_NEAR(double(n), primitive < 15 ? 10 : 15, 12);
}

TEST_F(Composing, CountsWhatCannotBePlaced) {
  annotation.objects[0].position = Vec3(1000, 0, 0);
  annotation.objects[1].label = Class::kMediumTree;  // other trees serve
  annotation.objects[2].label = Class::kLargeShrub;  // other shrubs serve
  const Composition c = compose(annotation, ground, set, {});
  EXPECT_EQ(c.off_ground, 1u);
  EXPECT_EQ(c.placed, 299u);
  EXPECT_EQ(c.borrowed.at("medium_tree"), 1u);
  EXPECT_EQ(c.borrowed.at("large_shrub"), 1u);
  EXPECT_EQ(primitives[number(c, 2)].label, Class::kLowShrub);
  std::erase_if(set.entries, [](const PrimitiveEntry& e) { return e.label == Class::kLowShrub; });
  const Composition bare = compose(annotation, ground, set, {});
  EXPECT_EQ(bare.left_out.at("large_shrub"), 1u);
  EXPECT_EQ(bare.placed, 298u);
  annotation.objects.clear();
  EXPECT_EQ(compose(annotation, ground, set, {}).scene.instances.size(), 1u);  // the ground remains
}

TEST_F(Composing, FillsAPatchCellByCell) {
  PlacedObject patch;
  patch.label = Class::kMediumShrubPatch;
  patch.position = Vec3(12, -18, 0);
  patch.yaw_rad = 0.7;
  patch.box = {Vec3(-4, -3, 0), Vec3(4, 3, 1.4)};
  annotation.objects = {patch};
  const Composition c = compose(annotation, ground, set, {});
  ASSERT_EQ(c.placed, 12u);
  const Pose back = patch.world_from_object().inverse();
  for (size_t k = 1; k <= 12; ++k) {  // centres on the grid of the patch
    const Vec3 at = back * c.scene.instances[k].world_from_model.translation;
    EXPECT_NEAR(std::remainder(at.x() + 5, 2), 0, 1e-2);
    EXPECT_NEAR(std::remainder(at.y() + 4, 2), 0, 1e-2);
  }
}

TEST_F(Composing, ThinsAndThickensByClass) {
  ComposeOptions options;
  options.density = {{Class::kSmallTree, 0.3}, {Class::kLargeTree, 2.5}};
  std::erase_if(annotation.objects, [&](const PlacedObject& o) {  // copies must stay on the mesh
    return (o.position - Vec3(10, -20, 0)).head<2>().cwiseAbs().maxCoeff() > 25;
  });
  const Composition c = compose(annotation, ground, set, options);
  const auto n = [&](Class label) {
    return double(std::count(c.info.labels.begin(), c.info.labels.end(), label));
  };
  const auto wanted = [&](Class label) {
    return double(std::count_if(annotation.objects.begin(), annotation.objects.end(),
                                [&](const PlacedObject& o) { return o.label == label; }));
  };
  EXPECT_NEAR(n(Class::kSmallTree), 0.3 * wanted(Class::kSmallTree), 15);
  EXPECT_NEAR(n(Class::kLargeTree), 2.5 * wanted(Class::kLargeTree), 20);
  options.density = {{Class::kSmallTree, -1}};
  EXPECT_THROW(compose(annotation, ground, set, options), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::primitives
