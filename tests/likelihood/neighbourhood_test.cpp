#include "underbrush/likelihood/neighbourhood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "likelihood/beams_above_ground.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::likelihood {
namespace {

Vec3 extents(const Mat3& covariance) { return eigenvalues(covariance).cwiseSqrt(); }

/// Evidence of very different weights, all of the density 0.5 1/m.
std::vector<Evidence> evidence_of(size_t count) {
  std::vector<Evidence> out;
  for (size_t k = 0; k < count; ++k) out.push_back({double(k), 2 * double(k)});
  return out;
}

/// Spheres of σ = 1 cm spread over a piece of a plane, or over a cube of the same side.
std::vector<elements::Ellipsoid> spheres(uint64_t seed, bool flat) {
  Stream random(seed);
  std::vector<elements::Ellipsoid> out(400);
  for (elements::Ellipsoid& e : out) {
    for (int k = 0; k < 3; ++k) e.mean[k] = float(random.uniform(0, 2));
    if (flat) e.mean[0] = float(0.01 * random.normal());
    e.set_covariance(1e-4 * Mat3::Identity());
  }
  return out;
}

std::vector<Neighbourhood> neighbourhoods(std::span<const elements::Ellipsoid> of,
                                          std::span<const Evidence> evidence) {
  return Neighbours(of).neighbourhoods(of, evidence);
}

TEST(Neighbourhood, IsFlatOnAWallAndRoundInACrownAndHasTheSizeOfTheEllipsoid) {
  for (const bool flat : {true, false}) {
    const std::vector<elements::Ellipsoid> of = spheres(31, flat);
    double ratio = 0;
    for (const auto& [shape, density] : neighbourhoods(of, evidence_of(of.size()))) {
      EXPECT_NEAR(density, 0.5, 1e-12);
      EXPECT_NEAR(shape.trace(), 3e-4, 1e-9);
      const Vec3 sigma = extents(shape);
      EXPECT_GT(sigma[0], 0);
      ratio += sigma[0] / sigma[1] / double(of.size());
    }
    if (flat) {
      EXPECT_LT(ratio, 0.35);
    } else {
      EXPECT_GT(ratio, 0.55);
    }
  }
}

TEST(Neighbourhood, TurnsWithTheWorldAndIsTheSameForAnyNumberOfThreads) {
  std::vector<elements::Ellipsoid> of = spheres(32, true);
  for (size_t k = 0; k < of.size(); ++k) {
    of[k].set_covariance(Vec3(0.001, 0.002, 0.0005 + 1e-6 * double(k)).asDiagonal());
  }
  const std::vector<Neighbourhood> before = neighbourhoods(of, evidence_of(of.size()));
  set_threads(1);
  const std::vector<Neighbourhood> one = neighbourhoods(of, evidence_of(of.size()));
  set_threads(0);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (elements::Ellipsoid& e : of) {
    e.mean = (turn * e.mean.cast<double>()).cast<float>();
    e.set_covariance(turn * e.covariance_matrix() * turn.transpose());
  }
  const std::vector<Neighbourhood> after = neighbourhoods(of, evidence_of(of.size()));
  for (size_t k = 0; k < of.size(); ++k) {
    EXPECT_EQ(before[k].shape, one[k].shape);
    EXPECT_EQ(before[k].density_per_m, one[k].density_per_m);
    EXPECT_LT((after[k].shape - turn * before[k].shape * turn.transpose()).norm(), 1e-6);
  }
}

TEST(Neighbourhood, KeepsItsMembersWhereEllipsoidsMoved) {
  const std::vector<elements::Ellipsoid> of = spheres(33, false);
  std::vector<elements::Ellipsoid> moved = of;
  const Vec3f step(5, -3, 2);
  for (elements::Ellipsoid& e : moved) e.mean += step;
  moved[7].mean = of[7].mean;  // far away from all others, which stay its neighbours
  const std::vector<Evidence> evidence = evidence_of(of.size());
  const std::vector<Neighbourhood> found = Neighbours(of).neighbourhoods(moved, evidence);
  const Vec3 along = step.cast<double>().normalized();
  EXPECT_GT(along.dot(found[7].shape * along), 0.9 * found[7].shape.trace());
}

TEST(Neighbourhood, OfOneOrNoneIsItself) {
  EXPECT_TRUE(neighbourhoods({}, {}).empty());
  elements::Ellipsoid alone;
  alone.set_covariance(Vec3(0.4, 0.2, 0.1).asDiagonal());
  const std::vector<Evidence> unseen(1), seen{{6, 3}};
  const std::vector<Neighbourhood> found = neighbourhoods(std::vector{alone}, unseen);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT((found[0].shape - alone.covariance_matrix()).norm(), 1e-7);
  EXPECT_EQ(found[0].density_per_m, 0);
  EXPECT_EQ(neighbourhoods(std::vector{alone}, seen)[0].density_per_m, 2);
}

/// A wall 10 m away with a permeable shrub before its middle, on level ground.
elements::Model wall_behind_a_shrub() {
  elements::Model m;
  m.tau = 4;
  m.ground = test::level_ground(0.005);
  m.surface.vertices = {{10, -8, 0}, {10, 8, 0}, {10, 8, 4}, {10, -8, 4}};
  m.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.surface.hit.resize(2);
  m.surface.range_sigma_m = 0.01;
  elements::Ellipsoid shrub;
  shrub.mean = {6, 0, 1.3f};
  shrub.set_covariance(Vec3(0.16, 0.25, 0.16).asDiagonal());
  shrub.density_per_m = 0.8f;
  m.ellipsoids = {shrub};
  return m;
}

BeamLog crossing_log(const elements::Model& truth, uint64_t seed, size_t n) {
  const test::BeamSpread spread{{-0.6, 0.6}, {-0.3, 0.25}, {-1, 1}, {-1, 1}};
  return test::answered(test::random_beams(seed, n, spread), truth, seed);
}

TEST(Neighbourhood, AWallIsAsSharpAsTheNoiseAndTheShrubBeforeItIsPermeable) {
  const elements::Model truth = wall_behind_a_shrub();
  const BeamLog log = crossing_log(truth, 33, 40000), fresh = crossing_log(truth, 34, 20000);
  MemorySource source(log);
  const elements::Model model = fit::fit(source, {}).model;
  const BeamLog answer = test::answered(fresh, model, 35);
  std::vector<double> errors;
  double through[2] = {0, 0}, behind = 0, beams = 0;
  for (size_t i = 0; i < fresh.size(); ++i) {
    const Vec3 at =
        fresh.origin[i] + 10 / double(fresh.direction[i].x()) * fresh.direction[i].cast<double>();
    const Vec3 shrub = fresh.origin[i] + (6 - fresh.origin[i].x()) /
                                             double(fresh.direction[i].x()) *
                                             fresh.direction[i].cast<double>();
    const bool crosses = (shrub - Vec3(6, 0, 1.3)).norm() < 0.4;
    const auto on_wall = [&](const BeamLog& of) {
      return std::abs(of.end_point(i).x() - 10) < 0.2;
    };
    if (crosses) {
      ++behind;
      through[0] += on_wall(fresh);
      through[1] += on_wall(answer);
    } else if (on_wall(fresh) && std::abs(at.y()) > 2) {
      ++beams;
      if (!answer.is_hit(i)) continue;
      errors.push_back(std::abs(double(answer.range_m[i]) - double(fresh.range_m[i])));
    }
  }
  ASSERT_GT(errors.size(), 3000u);
  ASSERT_GT(behind, 400);
  std::nth_element(errors.begin(), errors.begin() + ptrdiff_t(errors.size() / 2), errors.end());
  // Two draws of the truth differ by 0.0097 m. With spheres as priors the median is 0.02 m.
  EXPECT_LT(errors[errors.size() / 2], 0.016);
  EXPECT_GT(double(errors.size()), 0.99 * beams);
  EXPECT_NEAR(through[1] / behind, through[0] / behind, 0.15);
}

}  // namespace
}  // namespace underbrush::likelihood
