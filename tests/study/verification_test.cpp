#include "study/verification.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data.hpp"
#include "study/analytic_scanner.hpp"
#include "study/mesh_fidelity.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::app {
namespace {

StudyResult miniature_study(const std::function<void(scene::Solid&)>& change = {}) {
  StudyRun run;
  run.quick = true;
  StudyResult result;
  add_miniature(run, result, change);
  return result;
}

TEST(Verification, TwoSimulatorsAgreeAndAWrongTargetFallsShort) {
  const StudyResult good = miniature_study();
  ASSERT_EQ(good.checks.size(), 4u);
  for (size_t k = 0; k < 3; ++k) EXPECT_TRUE(good.checks[k].holds()) << good.checks[k].what;
  EXPECT_LT(good.checks[3].value, 0.003);
  const StudyResult wide = miniature_study([](scene::Solid& solid) {
    for (Vec3& v : solid.vertices) v *= 1.03;
  });
  EXPECT_EQ(verdict(wide.checks).rfind("falls short: ", 0), 0u);
  EXPECT_FALSE(wide.checks[2].holds());
}

TEST(Verification, TheIndependentScannerMeasuresAWallAtItsDistance) {
  // A wall perpendicular to the axis, 24 m away, wider than the view.
  scene::Solid wall = scene::block({1, 0, -5}, {2, 10, 10});
  AnalyticScanOptions options;
  options.half_field_rad = 0.01;
  const AnalyticScan scan =
      analytic_scan(wall, {Eigen::Quaterniond::Identity(), {-24, 0, 0}}, options);
  EXPECT_EQ(scan.points.size(), scan.shots);
  double sum = 0, squares = 0;
  for (const Vec3& p : scan.points) {
    sum += p.x() - 24;
    squares += (p.x() - 24) * (p.x() - 24);
  }
  const double n = double(scan.points.size());
  EXPECT_NEAR(sum / n, 0, 4 * 0.007 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.007, 0.0003);
}

TEST(MeshFidelity, VerdictFailsWhereFineTreesLookFlatOrCartoonsReal) {
  std::vector<PlantFigures> plants(3);
  const double epsilon[] = {0.6, 0.3, 0.05};
  std::vector<double> count, value(std::begin(epsilon), std::end(epsilon));
  for (size_t k = 0; k < 3; ++k) {
    plants[k].elements = k == 0 ? 2 : size_t(std::pow(100.0, double(k)));
    plants[k].crude = k < 2;
    plants[k].leaves.mean_rad = 1.65 + epsilon[k];
    plants[k].leaves.sigma_rad = 0.747;
    count.push_back(double(plants[k].elements));
  }
  const metrics::LogRegression line = metrics::log_regression(count, value);
  EXPECT_EQ(verdict(sweep_checks(plants, line)), "holds");
  for (const auto& [plant, mean] : {std::pair{0, 1.65}, {1, 1.7}, {2, 1.9}}) {
    std::vector<PlantFigures> broken = plants;
    broken[size_t(plant)].leaves.mean_rad = mean;
    EXPECT_NE(verdict(sweep_checks(broken, line)), "holds") << plant;
  }
  EXPECT_NE(verdict(sweep_checks(plants, {})), "holds");
}

/// The returns of one KITTI frame as beams from the origin.
BeamLog frame(uint32_t index) {
  BeamLog log;
  log.info.max_range_m = 120;
  const std::vector<float> values = test::kitti_frame("kitti_0052_static", index);
  log.resize(values.size() / 4);
  for (size_t i = 0; i < log.size(); ++i) {
    const Vec3f p(values[4 * i], values[4 * i + 1], values[4 * i + 2]);
    log.range_m[i] = p.norm();
    log.direction[i] = p.normalized();
  }
  return log;
}

// Two scans from a standing vehicle: the second measures the planes of the first.
TEST(Verification, RunsOnAPairOfRealScans) {
  UNDERBRUSH_NEEDS_DATA("kitti_0052_static");
  const WallFigures f = compare_walls(frame(0), frame(1), 1);
  ASSERT_GE(f.patches.size(), 5u);
  int upright = 0;
  for (const WallFigures::Patch& p : f.patches) {
    EXPECT_GT(p.real.points, 100u);
    EXPECT_LT(p.real.mean_m, 0.06);
    EXPECT_LT(p.simulated.mean_m, p.real.mean_m);
    upright += std::abs(p.plane.normal.z()) < 0.2;
  }
  EXPECT_GE(upright, 1);
}

}  // namespace
}  // namespace underbrush::app
