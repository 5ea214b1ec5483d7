#include "studies/ladder.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush::studies {
namespace {

elements::Model random_model(uint64_t seed, size_t n) {
  Stream random(seed);
  elements::Model m;
  for (size_t k = 0; k < n; ++k) {
    elements::Ellipsoid e;
    for (int d = 0; d < 3; ++d) e.mean[d] = float(random.uniform(-1, 1));
    Mat3 a;
    for (int d = 0; d < 9; ++d) a(d) = random.uniform(-0.2, 0.2);
    e.set_covariance(a * a.transpose() + 0.01 * Mat3::Identity());
    e.hit.hits = uint32_t(k);
    m.ellipsoids.push_back(e);
  }
  return m;
}

TEST(Ladder, TheDistanceBetweenShapesIsThatOfAShift) {
  elements::Model one = random_model(2, 1), other = one;
  other.ellipsoids[0].mean += Vec3f(0, 3, 4);
  EXPECT_NEAR(shape_distance(one, other), 5, 1e-5);
  const elements::Model a = random_model(3, 700), b = random_model(4, 300);
  EXPECT_EQ(shape_distance(a, a), 0);
  EXPECT_EQ(shape_distance(a, b), shape_distance(b, a));
  EXPECT_GT(shape_distance(a, b), 0);
}

TEST(Ladder, AFlattenedSceneHasTheElementsWhereTheInstancesStand) {
  elements::Scene scene;
  scene.models = {elements::Model(), random_model(5, 10)};
  scene.models[0].origin = Vec3(100, 200, 3);
  scene.instances.resize(2);
  scene.instances[0].world_from_model.translation = scene.models[0].origin;
  scene.instances[1] = {
      {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI_2, Vec3::UnitZ())), Vec3(101, 202, 4)}, 2, 1};
  const elements::Model flat = flattened(scene);
  ASSERT_EQ(flat.ellipsoids.size(), 10u);
  for (size_t k = 0; k < 10; ++k) {
    const elements::Ellipsoid &e = scene.models[1].ellipsoids[k], &f = flat.ellipsoids[k];
    const Vec3f expected(-2 * e.mean.y() + 1, 2 * e.mean.x() + 2, 2 * e.mean.z() + 1);
    EXPECT_LT((f.mean - expected).norm(), 1e-5);
    EXPECT_NEAR(f.covariance[0], 4 * e.covariance[3], 1e-6);   // xx was yy
    EXPECT_NEAR(f.covariance[1], -4 * e.covariance[1], 1e-6);  // xy
  }
}

TEST(Ladder, LeadsFromTheComposedSceneToTheFitOfTheTestLog) {
  const SitePair pair = generated_pair(51, 52, true);
  const std::vector<Rung> rungs = ladder(pair, 1);
  ASSERT_GT(rungs.size(), 4u);
  const metrics::Summary &bottom = rungs[1].score, &top = rungs[rungs.size() - 2].score;
  EXPECT_LT(top.packet_error_m, bottom.packet_error_m);
  EXPECT_LT(top.cloud_error_m, bottom.cloud_error_m);
  EXPECT_GT(top.informedness, bottom.informedness);
  elements::Model own = fit_of_log(pair.test, pair.min_range_m, 1);
  own.keyframes = nullptr;
  EXPECT_EQ(top.packet_error_m,
            scores_of(pair.test, answers_of_world(pipeline::TracedWorld(own), pair.test, 1))
                .all.packet_error_m);
  EXPECT_EQ(rungs.back().name, "always hit");
  EXPECT_EQ(rungs.back().score.informedness, 0);
}

}  // namespace
}  // namespace underbrush::studies
