#include "studies/verification.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "data.hpp"
#include "studies/analytic_scanner.hpp"
#include "studies/mesh_fidelity.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/label_sets.hpp"

namespace underbrush::studies {
namespace {

StudyResult miniature_study(const std::function<void(Solid&)>& change = {}) {
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
  const StudyResult wide = miniature_study([](Solid& solid) {
    for (Vec3& v : solid.vertices) v *= 1.03;
  });
  EXPECT_EQ(verdict(wide.checks).rfind("falls short: ", 0), 0u);
  EXPECT_FALSE(wide.checks[2].holds());
}

TEST(Verification, TheIndependentScannerMeasuresAWallAtItsDistance) {
  // A wall stands perpendicular to the axis at 24 m and is wider than the field of view.
  Solid wall = block({1, 0, -5}, {2, 10, 10});
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

// Trees and bushes of an off-road scan, chosen by human labels, lie within the criterion. The same
// scan with its ground does not.
TEST(MeshFidelity, RealOffRoadVegetationLiesInside) {
  UNDERBRUSH_NEEDS_DATA("rellis_000104");
  const std::filesystem::path folder = test::data_folder() / "rellis_000104";
  const std::string points = test::read_file(folder / "000104.bin");
  const std::string labels = test::read_file(folder / "000104.label");
  ASSERT_EQ(points.size(), 4 * labels.size());
  std::vector<Vec3f> vegetation, all;
  for (size_t i = 0; i < labels.size() / 4; ++i) {
    Vec3f p;
    uint32_t label = 0;
    std::memcpy(p.data(), points.data() + 16 * i, 12);
    std::memcpy(&label, labels.data() + 4 * i, 4);
    if (p.norm() < 3 || p.norm() > 25) continue;
    all.push_back(p);
    if (elements::is_vegetation("rellis", label & 0xFFFF)) vegetation.push_back(p);
  }
  ASSERT_GT(vegetation.size(), 10000u);
  const metrics::LeafInclination leaves = metrics::leaf_inclination(vegetation);
  EXPECT_LT(leaves.epsilon(), 0.05);
  // not π/2, because of the signs of the normals
  EXPECT_NEAR(leaves.mean_rad, metrics::LeafInclination::kRealMean, 0.05);
  EXPECT_FALSE(metrics::leaf_inclination(all).is_realistic());
}

TEST(MeshFidelity, SurfacePointsLieOnTheSurfaceByArea) {
  test_site::PlantMesh plant;  // two squares of area 1 and 3 at heights 0 and 1
  for (const auto& [z, width] : {std::pair{0.0, 1.0}, {1.0, 3.0}}) {
    const uint32_t a = plant.add_vertex({0, 0, z}), b = plant.add_vertex({width, 0, z});
    const uint32_t c = plant.add_vertex({width, 1, z}), d = plant.add_vertex({0, 1, z});
    plant.add_triangle(a, b, c, test_site::Part::kLeaf);
    plant.add_triangle(a, c, d, test_site::Part::kLeaf);
  }
  double high = 0, x = 0;
  constexpr size_t kN = 20000;
  for (const Vec3f& p : surface_points(plant, kN, 3)) {
    ASSERT_NEAR(p.z(), std::round(p.z()), 1e-6);
    high += p.z() > 0.5f;
    if (p.z() > 0.5f) x += double(p.x());
  }
  EXPECT_NEAR(high / kN, 0.75, 4 * std::sqrt(0.75 * 0.25 / kN));
  EXPECT_NEAR(x / high, 1.5, 0.03);
}

TEST(MeshFidelity, RegistrationErrorsAreTheSameForAScanAndAsLargeAsAsked) {
  BeamLog log;
  log.resize(4000);
  for (size_t i = 0; i < log.size(); ++i) {
    log.scan[i] = uint32_t(i / 2);
    log.direction[i] = Vec3f::UnitX();
    log.range_m[i] = 10;
  }
  const std::vector<Vec3f> exact = registered(log, {}, 1);
  ApproachOptions shifted;
  shifted.registration_m = 0.02;
  const std::vector<Vec3f> cloud = registered(log, shifted, 1);
  double squares = 0;
  for (size_t i = 0; i < cloud.size(); i += 2) {
    EXPECT_EQ(exact[i], Vec3f(10, 0, 0));
    EXPECT_EQ(cloud[i], cloud[i + 1]);
    squares += double((cloud[i] - exact[i]).squaredNorm()) / double(cloud.size() / 2);
  }
  EXPECT_NEAR(std::sqrt(squares / 3), 0.02, 0.001);
}

/// Reads the returns of one KITTI frame as beams from the origin.
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

// Both scans are from a standing vehicle; the second one measures the planes of the first.
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
}  // namespace underbrush::studies
