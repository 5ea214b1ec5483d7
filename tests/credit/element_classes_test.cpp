#include "underbrush/credit/element_classes.hpp"

#include <gtest/gtest.h>

#include "drive_past.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::credit {
namespace {

constexpr uint32_t kTree = 4, kDirt = 1, kCar = 8, kVoid = 0;  // of RELLIS

/// Makes a log of flat ground with a bush on either side, whose hits have labels of RELLIS.
BeamLog labelled_bushes(uint32_t left, uint32_t right, uint32_t ground = kDirt) {
  elements::Model truth = test::flat_ground(60);
  for (const float y : {-8.0f, 8.0f}) {
    test::add_bush(Vec3f(0, y, 1.2f), Vec3(0.3, 0.3, 0.2), 0.7f, truth);
  }
  BeamLog log = test::drive_past(truth, 5, 30000, 3000, -0.4);
  std::vector<uint8_t> label(log.size(), uint8_t(kVoid));
  for (size_t i = 0; i < log.size(); ++i) {
    if (!log.is_hit(i)) continue;
    const Vec3 at = log.end_point(i);
    label[i] = uint8_t(at.z() < 0.1 ? ground : at.y() < 0 ? left : right);
  }
  log.extra["class"] = label;
  log.info.classes = "rellis";
  return log;
}

TEST(ElementClasses, AreThoseOfMostHits) {
  const BeamLog log = labelled_bushes(kTree, kCar);
  MemorySource source(log);
  fit::FitOptions options;
  options.learn_grain = false;
  const elements::Model model = fit::fit(source, options).model;
  for (const std::string& name : model.class_names) {
    EXPECT_TRUE(name == "tree" || name == "vehicle" || name == "dirt") << name;
  }
  ASSERT_GT(model.ellipsoids.size(), 5u);
  size_t trees = 0, cars = 0;
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    const std::string name = model.class_name(e.label);
    const bool left = double(e.mean.y()) + model.origin.y() < 0;
    EXPECT_NE(name, left ? "vehicle" : "tree");
    trees += name == "tree";
    cars += name == "vehicle";
  }
  EXPECT_GT(trees, 2u);
  EXPECT_GT(cars, 2u);
  EXPECT_EQ(model.grain.classes.size(), model.class_names.size());
  for (const elements::ClassGrain& c : model.grain.classes) {
    EXPECT_EQ(c.side_m, elements::usual_grain_m(model.class_name(c.label)));
  }
  EXPECT_NE(elements::usual_grain_m("tree"), elements::usual_grain_m("vehicle"));
}

TEST(ElementClasses, DoNotChangeTheShapeOfTheModelNorAModelOfALogWithoutLabels) {
  BeamLog log = labelled_bushes(kVoid, kVoid, kVoid);
  MemorySource unknown(log);
  const elements::Model with = fit::fit(unknown, {}).model;
  EXPECT_TRUE(with.class_names.empty());
  EXPECT_TRUE(with.grain.classes.empty());
  log.extra.clear();
  log.info.classes.clear();
  MemorySource bare(log);
  const elements::Model without = fit::fit(bare, {}).model;
  ASSERT_EQ(with.ellipsoids.size(), without.ellipsoids.size());
  for (size_t i = 0; i < with.ellipsoids.size(); ++i) {
    EXPECT_EQ(with.ellipsoids[i].mean, without.ellipsoids[i].mean);
    EXPECT_EQ(with.ellipsoids[i].hit.p, without.ellipsoids[i].hit.p);
    EXPECT_EQ(with.ellipsoids[i].label, 0u);
  }
}

}  // namespace
}  // namespace underbrush::credit
