#include "studies/registration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "studies/range_histogram.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::studies {
namespace {

Pose turned(double angle, const Vec3& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3(0.3, -1, 2).normalized())), translation};
}

TEST(Align, RecoversASimilarityFromItsPoints) {
  Stream random(1);
  const Similarity truth{turned(2.1, {5, -3, 20}), 1.7};
  std::vector<Vec3> from, to;
  for (int i = 0; i < 5; ++i) {
    from.emplace_back(random.uniform(), random.uniform(), random.uniform());
    to.push_back(truth * from.back());
  }
  const Similarity found = align(from, to, false);
  EXPECT_NEAR(found.scale, 1.7, 1e-12);
  EXPECT_NEAR(found.pose.rotation.angularDistance(truth.pose.rotation), 0, 1e-7);
  EXPECT_TRUE(found.pose.translation.isApprox(truth.pose.translation, 1e-12));
  for (Vec3& p : to) p = turned(2.1, {5, -3, 20}) * from[size_t(&p - to.data())];
  const Similarity rigid = align(from, to);
  EXPECT_EQ(rigid.scale, 1);
  for (size_t i = 0; i < 5; ++i) EXPECT_TRUE((rigid * from[i]).isApprox(to[i], 1e-12));
}

TEST(Align, NeverMirrors) {
  const std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<Vec3> to = from;
  for (Vec3& p : to) p.x() = -p.x();
  EXPECT_NEAR(align(from, to).pose.rotation.toRotationMatrix().determinant(), 1, 1e-12);
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_THROW(align(line, line), std::invalid_argument);
  EXPECT_THROW(align(std::span(from).first(2), std::span(to).first(2)), std::invalid_argument);
}

/// Makes points with noise on three faces of a cube of 1 m.
std::vector<Vec3> cube(uint64_t seed, int n, double sigma) {
  Stream random(seed);
  std::vector<Vec3> out;
  for (int i = 0; i < n; ++i) {
    Vec3 p(random.uniform(), random.uniform(), random.uniform());
    p[i % 3] = sigma * random.normal();
    out.push_back(p);
  }
  return out;
}

TEST(Icp, ConvergesFromFiveDegrees) {
  const std::vector<Vec3> to = cube(1, 6000, 0.002), model = cube(2, 3000, 0.002);
  const Pose truth = turned(5 * M_PI / 180, {0.04, -0.03, 0.05});
  std::vector<Vec3> from;
  from.reserve(model.size());
  for (const Vec3& p : model) from.push_back(truth.inverse() * p);
  const IcpResult found = icp(from, to);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(found.to_from_from.rotation.angularDistance(truth.rotation), 1e-3);
  EXPECT_LT((found.to_from_from * from[0] - model[0]).norm(), 1e-3);
  EXPECT_GT(found.overlap, 0.8);
  EXPECT_NEAR(found.rms_m, 0.002, 0.001);
}

TEST(Icp, RefusesCloudsWithoutAnythingInCommon) {
  const std::vector<Vec3> to = cube(1, 60, 0);
  std::vector<Vec3> from = to;
  for (Vec3& p : from) p.x() += 50;
  EXPECT_THROW(icp(from, to), std::invalid_argument);
}

TEST(RangeHistograms, CountInTheSameBins) {
  const std::vector<double> a{24.0, 24.01, 24.06}, b{24.07, 24.11, 24.12, 24.13};
  const RangeHistograms h = range_histograms(a, b, 0.05);
  EXPECT_DOUBLE_EQ(h.a.first_m, 24);
  EXPECT_EQ(h.a.count, (std::vector<uint64_t>{2, 1, 0}));
  EXPECT_EQ(h.b.count, (std::vector<uint64_t>{0, 1, 3}));
  EXPECT_DOUBLE_EQ(h.largest_difference(), 0.75);
  EXPECT_DOUBLE_EQ(h.mean_difference(), (2.0 / 3 + 1.0 / 12 + 0.75) / 3);
  EXPECT_DOUBLE_EQ(h.mean_count_difference(), 5.0 / 3);
  EXPECT_EQ(range_histograms(a, a, 0.05).largest_difference(), 0);
  // Ranges are in steps of 1 mm. With bounds between two steps, a shift of 0.2 mm moves no range to
  // another bin.
  std::vector<double> steps, shifted;
  for (int k = 0; k < 500; ++k) {
    steps.push_back(24 + 0.001 * k);
    shifted.push_back(steps.back() - 0.0002);
  }
  EXPECT_GT(range_histograms(steps, shifted, 0.05).largest_difference(), 0.001);
  const RangeHistograms between = range_histograms(steps, shifted, 0.05, 0.0005);
  EXPECT_EQ(between.largest_difference(), 0);
  EXPECT_NEAR(between.a.first_m, 23.9505, 1e-9);
  EXPECT_THROW(range_histograms({}, b, 0.05), std::invalid_argument);
  EXPECT_THROW(range_histograms(a, b, 0), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::studies
