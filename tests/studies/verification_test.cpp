#include "studies/verification.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "data.hpp"
#include "studies/analytic_scanner.hpp"
#include "studies/mesh_fidelity.hpp"
#include "studies/verification_checks.hpp"
#include "studies/verification_study.hpp"
#include "studies/verification_walls.hpp"
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
  for (const Check& c : good.checks) {
    // Two scans are too few for the largest difference of the histograms.
    if (c.what.find("largest difference") == std::string::npos) {
      EXPECT_TRUE(c.holds()) << c.what << ": " << c.value;
    } else {
      EXPECT_LT(c.value, 0.003);
    }
  }
  // Each fault of a simulator is caught on the miniature; `good` has the checks that say so.
  for (const NamedFault& fault : faults()) {
    EXPECT_GE(good.figures["faults"]["miniature"][fault.name].get<int>(), 1) << fault.name;
  }
  const StudyResult wide = miniature_study([](Solid& solid) {
    for (Vec3& v : solid.vertices) v *= 1.03;
  });
  EXPECT_EQ(verdict(wide.checks).rfind("falls short: ", 0), 0u);
}

// For normal errors of equal spread the difference has mean 0 and variance 1, for any numbers of
// points; twice the spread is far out, on its side.
TEST(Verification, DifferenceOfSpreadsIsAStandardNormalNumber) {
  double sum = 0, squares = 0;
  constexpr int kTrials = 400;
  for (uint64_t trial = 0; trial < kTrials; ++trial) {
    double variance[2] = {0, 0};
    const int n[2] = {200, 50};
    for (int side = 0; side < 2; ++side) {
      for (int k = 0; k < n[side]; ++k) {
        const double e = normal(beam_key(7, trial, uint64_t(side)), uint32_t(k), Purpose::kNoise);
        variance[side] += e * e / n[side];
      }
    }
    const double z = spread_difference(variance[0], n[0], variance[1], n[1]);
    sum += z, squares += z * z;
  }
  EXPECT_NEAR(sum / kTrials, 0, 0.2);
  EXPECT_NEAR(squares / kTrials, 1, 0.25);
  EXPECT_GT(spread_difference(4, 1000, 1, 1000), kMostErrors);
  EXPECT_LT(spread_difference(1, 1000, 4, 1000), -kMostErrors);
  EXPECT_LT(spread_difference(0, 1000, 1, 1000), -kMostErrors);
}

// Two samples of one plane agree; one that is shifted or tilted by several standard errors beyond
// the allowance does not.
TEST(Verification, DifferencesOfPlanesSeeAShiftAndATilt) {
  const auto sample = [](uint64_t seed, double shift, double tilt) {
    std::vector<Vec3> points;
    for (uint32_t k = 0; k < 2000; ++k) {
      const uint64_t key = beam_key(seed, 0, k);
      const double x = uniform_from_bits(random_bits(key, 0, Purpose::kPlace)) - 0.5;
      const double y = uniform_from_bits(random_bits(key, 1, Purpose::kPlace)) - 0.5;
      points.emplace_back(x, y, shift + tilt * x + 0.007 * normal(key, 2, Purpose::kNoise));
    }
    return fit_plane(points);
  };
  const Plane real = sample(1, 0, 0);
  const auto differences = [&](double shift, double tilt, double allowance) {
    return plane_differences(sample(2, shift, tilt), 2000, real, 2000, allowance);
  };
  const PlaneDifferences same = differences(0, 0, 0);
  for (const double z : {same.spread, same.offset, same.slope[0], same.slope[1]}) {
    EXPECT_LT(std::abs(z), kMostErrors);
  }
  // The offset is known to 7 mm √(2/2000) = 0.22 mm, the slope to 0.22 mm √12 a metre.
  EXPECT_NEAR(differences(0.002, 0, 0).offset - same.offset, 0.002 / 0.000221, 0.5);
  EXPECT_NEAR(differences(0.002, 0, 0.0005).offset, differences(0.002, 0, 0).offset - 2.26, 0.2);
  const PlaneDifferences tilted = differences(0, 0.005, 0);
  EXPECT_GT(std::max(std::abs(tilted.slope[0]), std::abs(tilted.slope[1])), kMostErrors);
  EXPECT_LT(std::abs(tilted.spread), kMostErrors);
}

TEST(Verification, IntervalsAreStudents) {
  const Bounded two = bounded({1, 3});  // s = √2, and t of one degree of freedom is 63.657.
  EXPECT_NEAR(two.mean, 2, 1e-12);
  EXPECT_NEAR(two.high, 2 + 63.657, 1e-3);
  const Bounded ten = bounded({1, 2, 3, 4, 5, 6, 7, 8, 9, 10});  // t = 3.2498.
  EXPECT_NEAR(ten.high - ten.mean, 3.2498 * std::sqrt(55.0 / 6 / 10), 0.005);
  EXPECT_NEAR(ten.mean - ten.low, ten.high - ten.mean, 1e-12);
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

// Every other beam of a real scan answers the beams between them: planes with the noise of the scan
// pass, and each fault is caught.
TEST(Verification, RealWallsPassTheirOwnPlanesAndCatchEveryFault) {
  UNDERBRUSH_NEEDS_DATA("kitti_0052_static");
  std::vector<WallScan> scans;
  for (uint32_t k = 0; k < 4; ++k) scans.emplace_back(frame(k));
  const auto checks = [&](const ScannerFault& fault) {
    std::vector<std::vector<Wall>> walls;
    for (const WallScan& scan : scans) walls.push_back(scan.compare(WallSource::kFaces, fault, 1));
    const WallFigures f = wall_figures(walls);
    EXPECT_GE(f.walls, 12u);
    EXPECT_NEAR(f.spread.mean, fault.noise, 0.35 * fault.noise + 0.1);
    return wall_checks("walls", f);
  };
  for (const NamedFault& fault : faults()) {
    EXPECT_NE(verdict(checks(fault.fault)), "holds") << fault.name;
  }
  checks({});
}

}  // namespace
}  // namespace underbrush::studies
