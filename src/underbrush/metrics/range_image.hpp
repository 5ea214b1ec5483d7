/// \file
/// Panoramic range images of scans, and the scores of pairs of images that learned lidar simulators
/// publish (LiDAR4D [zheng24], on KITTI-360).
#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// The layout of a range image.
struct RangeImageLayout {
  int rows = 66, columns = 1030;
  double up_deg = 2.0;      ///< Elevation of the upper edge.
  double total_deg = 26.9;  ///< Field of view from the upper to the lower edge.
  double max_range_m = 80;
};

/// A range image: one depth per pixel, row by row from the top; column 0 looks backwards, and
/// columns turn clockwise. A pixel without a return is 0.
struct RangeImage {
  RangeImageLayout layout;
  std::vector<float> depth_m, intensity;
};

/// Draws the returns of a scan into an image, each in the sensor's frame at the beam's own time, as
/// the sensor itself would write them: the direction is turned back by the scan's pose, or in a
/// de-skewed log by the pose that is interpolated between those of the scans, and the depth is the
/// range. From one pose for all beams the motion within a scan would move returns of neighbouring
/// rings into each other's pixels. Of several returns in a pixel the nearest counts; returns at
/// `max_range_m` or farther and outside the field of view do not.
RangeImage range_image(const BeamLog& scan, const RangeImageLayout& layout = {});

/// Returns the points of the pixels with a return (m, in the sensor's frame), along the direction
/// of each pixel.
std::vector<Vec3f> points_of(const RangeImage& image);

/// Mean structural similarity of two images [wang04] over windows of 7 × 7 pixels with equal
/// weights, K₁ = 0.01, K₂ = 0.03 and unbiased covariances, over the pixels whose window lies within
/// the image. Throws `std::invalid_argument` for images smaller than a window.
double structural_similarity(std::span<const float> a, std::span<const float> b, int rows,
                             int columns, double value_range);

/// Scores of images, by the definitions of LiDAR4D's code; NaN without data.
struct ImageScores {
  double chamfer_m2 = 0;  ///< Sum of both mean squared distances between the clouds, m².
  double f_score = 0;     ///< F-score at a squared distance of 0.05 m².
  /// Over all pixels, depth at least 10⁻⁶ m and at most the maximum range. A pixel dropped in both
  /// has no error; one that is dropped in one image alone has its whole depth.
  double depth_rmse_m = 0, depth_median_m = 0;
  double depth_ssim = 0;  ///< Similarity over the range of real depths.
  double depth_psnr = 0;  ///< dB; PSNR of depth / maximum range.
  double intensity_rmse = 0;
  /// Scores of the 0 or 1 of a return in a pixel; the positive class of F1 is the return.
  double drop_rmse = 0, drop_accuracy = 0, drop_f1 = 0;
};
/// Compares two images of one layout.
ImageScores image_scores(const RangeImage& real, const RangeImage& simulated);

/// Means of `image_scores` over the scans of a log.
struct ProtocolScores {
  size_t scans = 0;
  double empty_share = 0;  ///< Mean share of pixels that no beam of the real log points into.
  ImageScores mean;
};
/// Compares two logs of the same beams scan by scan. Where the simulated log has no intensities at
/// all the intensity's score is NaN. Throws as `for_each_scan` does.
ProtocolScores range_image_scores(BeamSource& real, BeamSource& simulated,
                                  const RangeImageLayout& layout = {});

}  // namespace underbrush::metrics
