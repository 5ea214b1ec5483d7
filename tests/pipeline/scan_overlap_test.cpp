#include "underbrush/pipeline/scan_overlap.hpp"

#include <gtest/gtest.h>

#include "underbrush/core/rng.hpp"

namespace underbrush::pipeline {
namespace {

/// Points within 42 m along each axis, some of which are beyond the cells.
std::vector<Vec3> scattered(size_t n) {
  std::vector<Vec3> out;
  Stream random(5);
  for (size_t i = 0; i < n; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    out.emplace_back(84 * x - 42, 84 * y - 42, 4 * z - 1);
  }
  return out;
}

TEST(BestMotion, IsTheFirstOfTheLargestShareOfAllMotions) {
  const std::vector<Vec3> later = scattered(300);
  std::vector<Vec3> moved;
  moved.reserve(later.size());
  const Eigen::Quaterniond truth(Eigen::AngleAxisd(3 * M_PI / 180, Vec3::UnitZ()));
  for (const Vec3& p : later) moved.push_back(truth * p + Vec3(-1.2, 2.8, 0));
  const ScanCells cells(moved);
  ScanMotion expected;
  for (int turn = -10; turn <= 10; ++turn) {
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(turn * M_PI / 180, Vec3::UnitZ()));
    for (int x = -10; x <= 10; ++x) {
      for (int y = -10; y <= 10; ++y) {
        const Pose pose{rotation, Vec3(x * 0.4, y * 0.4, 0)};
        const double share = cells.share_of(later, pose);
        if (share > expected.share) expected = {pose, share};
      }
    }
  }
  const ScanMotion found = best_motion(cells, later);
  EXPECT_EQ(found.share, expected.share);
  EXPECT_EQ(found.pose.translation, expected.pose.translation);
  EXPECT_EQ(found.pose.rotation.coeffs(), expected.pose.rotation.coeffs());
  EXPECT_GT(found.share, 0.8);
  EXPECT_LT((found.pose.translation - Vec3(-1.2, 2.8, 0)).norm(), 1e-9);
}

TEST(BestMotion, HasNoShareWithoutPoints) {
  EXPECT_EQ(best_motion(ScanCells(scattered(10)), {}).share, 0);
  EXPECT_EQ(best_motion(ScanCells({}), scattered(10)).share, 0);
}

}  // namespace
}  // namespace underbrush::pipeline
