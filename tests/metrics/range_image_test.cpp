#include "underbrush/metrics/range_image.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace underbrush::metrics {
namespace {

/// Returns an image of one depth.
RangeImage flat(float depth, float intensity = 0) {
  RangeImage image;
  image.depth_m.assign(66 * 1030, depth);
  image.intensity.assign(66 * 1030, intensity);
  return image;
}

BeamLog scan_of(const std::vector<Vec3f>& points) {
  BeamLog log;
  log.resize(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    log.range_m[i] = points[i].norm();
    log.direction[i] = points[i].normalized();
  }
  return log;
}

TEST(RangeImage, PointsOfAnImageFallBackIntoTheirPixels) {
  RangeImage image = flat(0);
  for (size_t k = 0; k < image.depth_m.size(); ++k) image.depth_m[k] = 5 + float(k % 97) / 2;
  // Column 0 lies on the seam behind the sensor, where the sign of zero decides.
  for (size_t row = 0; row < 66; ++row) image.depth_m[row * 1030] = 0;
  const RangeImage again = range_image(scan_of(points_of(image)));
  size_t same = 0;
  for (size_t k = 0; k < image.depth_m.size(); ++k) {
    same += std::abs(image.depth_m[k] - again.depth_m[k]) < 1e-4f;
  }
  EXPECT_EQ(same, image.depth_m.size());
}

TEST(RangeImage, ForwardIsTheMiddleColumnAndTheNearestCounts) {
  const RangeImage image = range_image(scan_of({{30, 0, 0}, {20, 0, 0}, {0, 90, 0}, {0, 0, 9}}));
  // Elevation 0 lies 2 of 26.9 degrees below the upper edge.
  const size_t row = size_t(std::lround(2 / 26.9 * 66));
  EXPECT_EQ(image.depth_m[row * 1030 + 515], 20);
  size_t returns = 0;
  for (const float d : image.depth_m) returns += d > 0;
  EXPECT_EQ(returns, 1u);  // 90 m is too far, and upwards is outside the field of view.
}

/// Two scans of a sensor that drives and turns, 64 rings of 500 beams, in the frame of the world;
/// ranges are those of `raw`, which the sensor measured in its own frame.
BeamLog driven(const std::vector<Vec3f>& raw) {
  BeamLog log;
  log.info.deskewed = true;
  std::vector<StampedPose> poses;
  for (uint32_t scan = 0; scan < 3; ++scan) {
    const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.2 * scan, Vec3(0.1, 0.2, 1).normalized()));
    log.info.scans.push_back({scan, 0.1 * scan, {turned, Vec3(1.5 * scan, 0.3 * scan, 0)}});
    poses.push_back({0.1 * scan, log.info.scans.back().world_from_sensor});
  }
  const Trajectory path(poses);
  log.resize(raw.size());
  for (size_t i = 0; i < raw.size(); ++i) {
    log.scan[i] = 1;
    log.time_s[i] = 0.05 + 0.1 * double(i) / double(raw.size());
    const Pose pose = *path.at(log.time_s[i]);
    log.origin[i] = pose.translation;
    log.direction[i] = (pose.rotation * raw[i].cast<double>()).normalized().cast<float>();
    log.range_m[i] = raw[i].norm();
  }
  return log;
}

TEST(RangeImage, OfAMovingSensorIsWhatTheSensorMeasured) {
  std::vector<Vec3f> raw;
  for (int k = 0; k < 1000; ++k) {
    for (int ring = 0; ring < 60; ++ring) {
      // The middle of a pixel, and depths that differ from ring to ring.
      const double beta = M_PI - (k + 10) * 2 * M_PI / 1030;
      const double alpha = (2 - (ring + 3) * 26.9 / 66) * M_PI / 180;
      raw.push_back(((5 + ring % 7 * 4) * Vec3(std::cos(alpha) * std::cos(beta),
                                               std::cos(alpha) * std::sin(beta), std::sin(alpha)))
                        .cast<float>());
    }
  }
  const RangeImage measured = range_image(scan_of(raw)), image = range_image(driven(raw));
  size_t returns = 0, same = 0;
  for (size_t k = 0; k < measured.depth_m.size(); ++k) {
    if (measured.depth_m[k] == 0) continue;
    ++returns;
    same += std::abs(measured.depth_m[k] - image.depth_m[k]) < 1e-4f;
  }
  EXPECT_EQ(returns, 60000u);
  EXPECT_EQ(same, returns);
}

TEST(RangeImage, ShiftedDepthHasScoresInClosedForm) {
  const ImageScores s = image_scores(flat(10, 0.5f), flat(10.2f, 0.25f));
  EXPECT_NEAR(s.depth_rmse_m, 0.2, 1e-5);
  EXPECT_NEAR(s.depth_median_m, 0.2, 1e-5);
  EXPECT_NEAR(s.depth_psnr, 20 * std::log10(80 / 0.2), 1e-3);
  EXPECT_NEAR(s.intensity_rmse, 0.25, 1e-6);
  EXPECT_NEAR(s.chamfer_m2, 2 * 0.04, 1e-4);  // The sum of both means of squares.
  EXPECT_EQ(s.drop_accuracy, 1);
  // The threshold of the F score is 0.05 of the squared distance, 22.4 cm.
  EXPECT_NEAR(image_scores(flat(10), flat(10.22f)).f_score, 1, 1e-9);
  EXPECT_NEAR(image_scores(flat(10), flat(10.23f)).f_score, 0, 1e-9);
}

TEST(RangeImage, DroppedInBothIsFreeAndDroppedInOneCostsItsDepth) {
  RangeImage real = flat(8), simulated = flat(8);
  const double n = 66 * 1030;
  for (size_t k = 0; k < 1000; ++k) real.depth_m[k] = simulated.depth_m[k] = 0;
  EXPECT_EQ(image_scores(real, simulated).depth_rmse_m, 0);
  for (size_t k = 1000; k < 1300; ++k) simulated.depth_m[k] = 0;  // Lost.
  for (size_t k = 0; k < 100; ++k) simulated.depth_m[k] = 8;      // Made up.
  const ImageScores s = image_scores(real, simulated);
  EXPECT_NEAR(s.depth_rmse_m, 8 * std::sqrt(400 / n), 1e-6);
  EXPECT_NEAR(s.drop_rmse, std::sqrt(400 / n), 1e-12);
  EXPECT_NEAR(s.drop_accuracy, 1 - 400 / n, 1e-12);
  const double both = n - 1300;
  EXPECT_NEAR(s.drop_f1, 2 * both / (2 * both + 400), 1e-12);
  // Zero pixels are no points, so none lies at the sensor, 8 m from all others.
  EXPECT_LT(image_scores(flat(8), simulated).chamfer_m2, 0.01);
  EXPECT_TRUE(points_of(flat(0)).empty());
}

TEST(RangeImage, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  RangeImage real = flat(8), simulated = flat(8);
  for (size_t k = 0; k < 66 * 1030 / 2; ++k) simulated.depth_m[k] = 9;
  EXPECT_NEAR(image_scores(real, simulated).depth_median_m, 0.5, 1e-9);
}

TEST(StructuralSimilarity, OfConstantsAndOfACheckerboardIsTheFormula) {
  const int rows = 20, columns = 30;
  std::vector<float> a(size_t(rows * columns), 3), b(size_t(rows * columns), 5);
  const double c1 = std::pow(0.01 * 10, 2), c2 = std::pow(0.03 * 10, 2);
  EXPECT_NEAR(structural_similarity(a, b, rows, columns, 10), (30 + c1) / (34 + c1), 1e-12);
  EXPECT_NEAR(structural_similarity(a, a, rows, columns, 10), 1, 1e-12);
  for (int k = 0; k < rows * columns; ++k) {
    a[size_t(k)] = (k / columns + k % columns) % 2 ? 1 : -1;
    b[size_t(k)] = -a[size_t(k)];
  }
  // A window of 49 has one more of one colour; variances are unbiased.
  const double m2 = 1.0 / (49 * 49), v = 49.0 / 48 * (1 - m2);
  EXPECT_NEAR(structural_similarity(a, b, rows, columns, 10),
              (-2 * m2 + c1) * (-2 * v + c2) / ((2 * m2 + c1) * (2 * v + c2)), 1e-9);
}

TEST(RangeImage, ScoresOfALogAreMeansOverItsScansForAnyChunks) {
  BeamLog real, simulated;
  for (uint32_t scan = 0; scan < 2; ++scan) {
    for (int k = 0; k < 500; ++k) {
      const float a = 0.01f * float(k);
      real.append(scan_of({Vec3f(10 * std::cos(a), 10 * std::sin(a), 0)}), 0);
      real.scan.back() = scan;
    }
  }
  simulated = real;
  for (size_t i = 500; i < 1000; ++i) simulated.range_m[i] += 1;
  MemorySource a(real, 333), b(simulated, 77);
  const ProtocolScores s = range_image_scores(a, b);
  EXPECT_EQ(s.scans, 2u);
  BeamLog scan = real.like(), other = real.like();
  scan.append(real, 500, 1000);
  other.append(simulated, 500, 1000);
  EXPECT_NEAR(s.mean.depth_rmse_m,
              0.5 * image_scores(range_image(scan), range_image(other)).depth_rmse_m, 1e-12);
  EXPECT_GT(s.mean.depth_rmse_m, 0);
  EXPECT_TRUE(std::isnan(s.mean.intensity_rmse));  // The simulation has none.
  EXPECT_GT(s.empty_share, 0.98);
}

}  // namespace
}  // namespace underbrush::metrics
