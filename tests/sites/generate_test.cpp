#include "underbrush/sites/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "primitives/sites.hpp"

namespace underbrush::sites {
namespace {

using elements::ClassKind;
using primitives::GroundSurface;
using primitives::PlacedObject;

size_t count(const std::vector<PlacedObject>& objects, ClassKind kind) {
  return size_t(std::count_if(objects.begin(), objects.end(), [&](const PlacedObject& o) {
    return elements::kind_of(o.label) == kind;
  }));
}

TEST(Generate, GivesTheDensityAskedFor) {
  const elements::Model m = test::plane(60, 0.1, 0.05);  // 14400 m²
  const GroundSurface ground(m);
  for (const double density : {0.01, 0.05, 0.1}) {
    GenerateOptions o;
    o.density = density;
    EXPECT_NEAR(double(count(generate_objects(ground, o).objects, ClassKind::kTree)),
                density * 14400, 1);
  }
  GenerateOptions o;
  o.kind = "meadow";
  o.density = 0.03;
  const auto meadow = generate_objects(ground, o).objects;
  EXPECT_NEAR(double(count(meadow, ClassKind::kShrub)), 0.03 * 14400, 1);
  EXPECT_NEAR(double(count(meadow, ClassKind::kPatch)) * 4 / 14400, 0.5, 0.2);
}

TEST(Generate, StandsOnTheGroundWithinItsMargin) {
  const elements::Model m = test::plane(40, 0.2, -0.1);
  const GroundSurface ground(m);
  for (const std::string& kind : site_kinds()) {
    GenerateOptions o;
    o.kind = kind;
    o.margin_m = 5;
    const auto objects = generate_objects(ground, o).objects;
    EXPECT_GT(objects.size(), 10u) << kind;
    for (const PlacedObject& p : objects) {
      ASSERT_LE((p.position - m.origin).head<2>().cwiseAbs().maxCoeff(), 35);
      ASSERT_NEAR(p.position.z(), ground.at(p.position.x(), p.position.y()).value(), 1e-9);
      ASSERT_GT(p.box.size().minCoeff(), 0);
      ASSERT_NE(elements::kind_of(p.label), ClassKind::kOther);
    }
  }
}

TEST(Generate, DependsOnTheSeedAlone) {
  const elements::Model m = test::plane(40, 0, 0);
  const GroundSurface ground(m);
  GenerateOptions o;
  const auto a = generate_objects(ground, o).objects, b = generate_objects(ground, o).objects;
  o.seed = 2;
  const auto c = generate_objects(ground, o).objects;
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].position, b[k].position);
  EXPECT_NE(a[0].position, c[0].position);
}

TEST(Generate, DrawsOnlyClassesThatAreAllowed) {
  const elements::Model m = test::plane(40, 0, 0);
  const GroundSurface ground(m);
  for (const std::string& kind : site_kinds()) {
    GenerateOptions o;
    o.kind = kind;
    const size_t all = generate_objects(ground, o).objects.size();
    using enum elements::Class;
    o.classes = {kMediumTree, kSmallShrub, kSmallShrubPatch};
    const DrawnSite drawn = generate_objects(ground, o);
    for (const PlacedObject& p : drawn.objects) ASSERT_TRUE(is_allowed(o.classes, p.label));
    EXPECT_TRUE(drawn.left_out.empty()) << kind;
    EXPECT_NEAR(double(drawn.objects.size()), double(all), 0.1 * double(all)) << kind;
    EXPECT_GT(drawn.replaced.size(), 1u);
    o.classes = {kGrass};  // No object is grass.
    const DrawnSite none = generate_objects(ground, o);
    EXPECT_TRUE(none.objects.empty()) << kind;
    size_t left_out = 0;
    for (const auto& [label, n] : none.left_out) left_out += n;
    EXPECT_NEAR(double(left_out), double(all), 0.1 * double(all)) << kind;
  }
}

TEST(Generate, RefusesWhatItDoesNotKnow) {
  const elements::Model m = test::plane(40, 0, 0);
  const GroundSurface ground(m);
  GenerateOptions o;
  o.kind = "jungle";
  EXPECT_THROW(generate_objects(ground, o), std::invalid_argument);
  o = {};
  o.density = -1;
  EXPECT_THROW(generate_objects(ground, o), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::sites
