#include "studies/plane_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "studies/planar_patches.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/metrics/normals.hpp"

namespace underbrush::studies {
namespace {

/// Makes points of a 2 m × 1 m rectangle that are off it along the normal by N(0, σ²).
std::vector<Vec3> rectangle(const Pose& pose, int n, double sigma, Stream& random) {
  std::vector<Vec3> out;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-0.5, 0.5);
    const double z = sigma * random.normal();
    out.push_back(pose * Vec3(x, y, z));
  }
  return out;
}

Pose tilted(double angle) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3(1, 2, 0.5).normalized())),
          Vec3(12, -7, 3)};
}

TEST(PlaneFit, FindsAnExactPlane) {
  Stream random(1);
  for (const double angle : {0.0, 0.7, M_PI_2, 2.5}) {
    const Pose pose = tilted(angle);
    const Plane p = fit_plane(rectangle(pose, 20, 0, random));
    EXPECT_NEAR(std::abs(p.normal.dot(pose.rotation * Vec3::UnitZ())), 1, 1e-12);
    EXPECT_NEAR(p.distance(pose.translation), 0, 1e-12);
    EXPECT_LT(p.variance, 1e-24);
    EXPECT_NEAR(p.u.cross(p.v).dot(p.normal), 1, 1e-12);
  }
}

// By law, E σ̂₀² = σ², and the estimates scatter by their stated covariance.
TEST(PlaneFit, CovarianceIsThatOfTheEstimates) {
  constexpr double kSigma = 0.01;
  constexpr int kRuns = 3000, kPoints = 40;
  const Pose pose = tilted(0.6);
  const Vec3 n = pose.rotation * Vec3::UnitZ(), x = pose.rotation * Vec3::UnitX(),
             y = pose.rotation * Vec3::UnitY();
  Stream random(2);
  double variance = 0;
  Vec3 scatter = Vec3::Zero(), stated = Vec3::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const Plane p = fit_plane(rectangle(pose, kPoints, kSigma, random));
    variance += p.variance / kRuns;
    const double sign = p.normal.dot(n) > 0 ? 1 : -1;
    const double about = sign * n.dot(p.centre - pose.translation);
    // Slopes are taken along the rectangle's own axes, and the stated ones are rotated to them.
    const Vec3 error(about, -sign * p.normal.dot(x), -sign * p.normal.dot(y));
    scatter += error.cwiseProduct(error) / kRuns;
    const Eigen::Vector2d ax(x.dot(p.u), x.dot(p.v)), ay(y.dot(p.u), y.dot(p.v));
    const Eigen::Matrix2d slopes = p.covariance.bottomRightCorner<2, 2>();
    stated += Vec3(p.covariance(0, 0), ax.dot(slopes * ax), ay.dot(slopes * ay)) / kRuns;
  }
  EXPECT_NEAR(variance / (kSigma * kSigma), 1, 0.02);
  EXPECT_NEAR(scatter[1] / stated[1], 1, 0.1);
  EXPECT_NEAR(scatter[2] / stated[2], 1, 0.1);
  EXPECT_NEAR(stated[0], kSigma * kSigma / kPoints, 0.02 * kSigma * kSigma / kPoints);
}

TEST(PlaneFit, HeightPlaneIsTheNormalEquations) {
  Stream random(3);
  std::vector<Vec3> points;
  Mat3 normal = Mat3::Zero();
  Vec3 right = Vec3::Zero();
  for (int i = 0; i < 200; ++i) {
    Vec3 p(random.uniform(-1, 1), random.uniform(23, 25), 0);
    p.z() = 0.3 * p.x() - 0.17 * p.y() + 4.6 + 0.01 * random.normal();
    points.push_back(p);
    const Vec3 row(p.x(), p.y(), 1);
    normal += row * row.transpose();
    right += p.z() * row;
  }
  const HeightPlane plane = fit_height_plane(points);
  const Mat3 inverse = normal.inverse();
  const Vec3 xi = inverse * right;
  double variance = 0;
  for (const Vec3& p : points) variance += std::pow(xi.dot(Vec3(p.x(), p.y(), 1)) - p.z(), 2) / 197;
  EXPECT_TRUE(plane.parameters.isApprox(xi, 1e-9));
  EXPECT_NEAR(plane.variance, variance, 1e-12);
  EXPECT_TRUE(plane.covariance.isApprox(variance * inverse, 1e-6));
  EXPECT_NEAR(plane.variance, 1e-4, 2e-5);
}

// In [kim12] table 3, a steep patch's slope comes out too flat where errors are along the beam.
TEST(PlaneFit, HeightPlaneFlattensWhatIsSteepAndThePerpendicularFitDoesNot) {
  Stream random(4);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) {
    const double z = random.uniform(-0.1, 0.1), noise = 0.007 * random.normal();
    points.emplace_back(random.uniform(-0.1, 0.1), 24 - z / 5.3 + noise, z);
  }
  const Plane plane = fit_plane(points);
  EXPECT_NEAR(-plane.normal.y() / plane.normal.z(), -5.3, 0.3);
  EXPECT_GT(fit_height_plane(points).parameters.y(), -4.2);
}

TEST(PlaneFit, ThreePlanesMeetInTheirCorner) {
  Plane planes[3];
  const Vec3 corner(1, -2, 3);
  for (int i = 0; i < 3; ++i) {
    planes[i].normal = tilted(0.4).rotation * Vec3::Unit(i);
    planes[i].offset_m = planes[i].normal.dot(corner);
  }
  EXPECT_TRUE(intersection(planes[0], planes[1], planes[2]).isApprox(corner, 1e-12));
  EXPECT_THROW(intersection(planes[0], planes[1], planes[1]), std::invalid_argument);
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}};
  EXPECT_THROW(fit_plane(line), std::invalid_argument);
  EXPECT_THROW(fit_height_plane(line), std::invalid_argument);
  EXPECT_THROW(fit_plane(std::span(line).first(3)), std::invalid_argument);
}

TEST(PlanarPatches, FindsTheSidesOfABoxAndNothingInABush) {
  Stream random(5);
  std::vector<Vec3f> cloud;
  for (int side = 0; side < 3; ++side) {
    for (int i = 0; i < 1500; ++i) {
      Vec3 p(random.uniform(), random.uniform(), random.uniform());
      p[side] = 0.005 * random.normal();
      cloud.push_back(p.cast<float>());
    }
  }
  for (int i = 0; i < 1500; ++i) {
    cloud.emplace_back(float(random.uniform(3, 4)), float(random.uniform()),
                       float(random.uniform()));
  }
  PatchOptions options;
  options.most_distance_m = 0.02;
  const std::vector<PlanarPatch> patches = planar_patches(cloud, options);
  ASSERT_EQ(patches.size(), 3u);
  for (const PlanarPatch& patch : patches) {
    EXPECT_GT(patch.points.size(), 1200u);
    EXPECT_GT(patch.plane.normal.maxCoeff(), 0.999);
    EXPECT_GE(patch.outline.size(), 4u);
    for (const Vec3& corner : patch.outline) EXPECT_NEAR(patch.plane.distance(corner), 0, 1e-9);
  }
}

TEST(Normals, AreTheDirectionOfLeastSpreadForEverySurface) {
  Stream random(6);
  for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(1, -2, 0.5)}) {
    const Mat3 frame = turn_between(Vec3::UnitZ(), n).toRotationMatrix();
    for (const double width : {1.0, 0.05}) {  // round, and nearly a line
      std::vector<Vec3f> cloud;
      for (int i = 0; i < 60; ++i) {
        const double a = random.uniform(-1, 1), b = random.uniform(-width, width);
        cloud.push_back((frame * Vec3(a, b, 1e-4 * random.normal())).cast<float>());
      }
      for (const Vec3f& found : metrics::normals(cloud, 60)) {
        EXPECT_NEAR(std::abs(found.cast<double>().dot(n.normalized())), 1, 1e-4) << n.transpose();
      }
    }
  }
  const std::vector<Vec3f> same(5, Vec3f(1, 2, 3));
  EXPECT_EQ(metrics::normals(same, 3)[0], Vec3f::UnitZ());
}

}  // namespace
}  // namespace underbrush::studies
