#include "underbrush/metrics/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/metrics/nearest.hpp"
#include "underbrush/metrics/scan_pairs.hpp"

namespace underbrush::metrics {
namespace {

constexpr int kWindow = 7;
constexpr double kLeastDepthM = 1e-6;
constexpr double kSquaredDistanceM2 = 0.05;

/// Returns the pixel that a direction in the sensor's frame falls into, or -1.
int pixel_of(const Vec3& d, const RangeImageLayout& l) {
  const double down = (l.total_deg - l.up_deg) * M_PI / 180, total = l.total_deg * M_PI / 180;
  const double beta = M_PI - std::atan2(d.y(), d.x());
  const double alpha = std::atan2(d.z(), std::hypot(d.x(), d.y())) + down;
  const auto column = long(std::nearbyint(beta / (2 * M_PI / l.columns)));
  const auto row = long(std::nearbyint(l.rows - alpha / (total / l.rows)));
  if (row < 0 || row >= l.rows || column < 0 || column >= l.columns) return -1;
  return int(row) * l.columns + int(column);
}

/// Sums over the window around a pixel.
struct WindowSums {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double x, double y) { a += x, b += y, aa += x * x, bb += y * y, ab += x * y; }
};

double similarity(const WindowSums& s, double c1, double c2) {
  constexpr double kPixels = kWindow * kWindow, kUnbiased = kPixels / (kPixels - 1);
  const double a = s.a / kPixels, b = s.b / kPixels;
  const double aa = kUnbiased * (s.aa / kPixels - a * a), bb = kUnbiased * (s.bb / kPixels - b * b);
  const double ab = kUnbiased * (s.ab / kPixels - a * b);
  return (2 * a * b + c1) * (2 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
}

/// Adds Chamfer distance and F score of the two clouds.
void score_clouds(const std::vector<Vec3f>& real, const std::vector<Vec3f>& simulated,
                  ImageScores& out) {
  out.chamfer_m2 = out.f_score = NAN;
  if (real.empty() || simulated.empty()) return;
  double mean[2], near[2];
  for (const int side : {0, 1}) {
    const Nearest n = nearest(side == 0 ? real : simulated, side == 0 ? simulated : real);
    mean[side] = near[side] = 0;
    for (const float d : n.distance_m) {
      const double squared = double(d) * double(d), share = 1 / double(n.distance_m.size());
      mean[side] += squared * share;
      if (squared < kSquaredDistanceM2) near[side] += share;
    }
  }
  out.chamfer_m2 = mean[0] + mean[1];
  out.f_score = near[0] + near[1] > 0 ? 2 * near[0] * near[1] / (near[0] + near[1]) : 0;
}

void score_drops(const RangeImage& real, const RangeImage& simulated, ImageScores& out) {
  double wrong = 0, both = 0, returns[2] = {0, 0};
  const size_t n = real.depth_m.size();
  for (size_t k = 0; k < n; ++k) {
    const bool a = real.depth_m[k] > 0, b = simulated.depth_m[k] > 0;
    wrong += a != b;
    both += a && b;
    returns[0] += a;
    returns[1] += b;
  }
  out.drop_rmse = std::sqrt(wrong / double(n));
  out.drop_accuracy = 1 - wrong / double(n);
  out.drop_f1 = returns[0] + returns[1] > 0 ? 2 * both / (returns[0] + returns[1]) : NAN;
}

/// The fields of `ImageScores`, to sum them up.
constexpr double ImageScores::*kFields[] = {
    &ImageScores::chamfer_m2,     &ImageScores::f_score,    &ImageScores::depth_rmse_m,
    &ImageScores::depth_median_m, &ImageScores::depth_ssim, &ImageScores::depth_psnr,
    &ImageScores::intensity_rmse, &ImageScores::drop_rmse,  &ImageScores::drop_accuracy,
    &ImageScores::drop_f1};

/// The frame of the sensor at the times of a scan's beams.
class BeamFrames {
 public:
  explicit BeamFrames(const BeamLog& scan)
      : scan_(scan), of_scan_(sensor_from_world(scan.info, scan.scan.at(0))) {
    if (!scan.info.deskewed) return;
    std::map<double, Pose> at_time;  // Scans that share a time have one pose.
    for (const ScanInfo& s : scan.info.scans) at_time.emplace(s.time_s, s.world_from_sensor);
    std::vector<StampedPose> poses;
    poses.reserve(at_time.size());
    for (const auto& [time_s, pose] : at_time) poses.push_back({time_s, pose});
    poses_ = Trajectory(std::move(poses));
  }
  /// The direction of a beam in the sensor's frame.
  Vec3 direction(size_t i) const {
    const Vec3 d = scan_.direction[i].cast<double>();
    if (poses_.empty()) return of_scan_ * d;
    const std::optional<Pose> pose = poses_.at(scan_.time_s[i]);
    return pose ? Vec3(pose->rotation.conjugate() * d) : Vec3(of_scan_ * d);
  }

 private:
  const BeamLog& scan_;
  Mat3 of_scan_;
  Trajectory poses_;
};

/// Returns the share of pixels that no beam points into.
double empty_share(const BeamLog& scan, const RangeImageLayout& layout) {
  const BeamFrames frames(scan);
  std::vector<bool> seen(size_t(layout.rows) * size_t(layout.columns));
  for (size_t i = 0; i < scan.size(); ++i) {
    const int pixel = pixel_of(frames.direction(i), layout);
    if (pixel >= 0) seen[size_t(pixel)] = true;
  }
  return double(std::count(seen.begin(), seen.end(), false)) / double(seen.size());
}

}  // namespace

RangeImage range_image(const BeamLog& scan, const RangeImageLayout& layout) {
  require(layout.rows > 0 && layout.columns > 0 && layout.total_deg > 0 && layout.max_range_m > 0,
          "range image: its size, field of view and range must be positive");
  RangeImage out{layout, {}, {}};
  const size_t pixels = size_t(layout.rows) * size_t(layout.columns);
  out.depth_m.assign(pixels, 0);
  out.intensity.assign(pixels, 0);
  if (scan.empty()) return out;
  const BeamFrames frames(scan);
  for (size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i)) continue;
    const float depth = scan.range_m[i];
    if (!(depth > 0) || double(depth) >= layout.max_range_m) continue;
    const int pixel = pixel_of(frames.direction(i), layout);
    if (pixel < 0) continue;
    float& nearest = out.depth_m[size_t(pixel)];
    if (nearest != 0 && nearest <= depth) continue;
    nearest = depth;
    out.intensity[size_t(pixel)] = scan.intensity[i];
  }
  return out;
}

std::vector<Vec3f> points_of(const RangeImage& image) {
  const RangeImageLayout& l = image.layout;
  std::vector<Vec3f> out;
  for (int row = 0; row < l.rows; ++row) {
    for (int column = 0; column < l.columns; ++column) {
      const double depth = double(image.depth_m[size_t(row) * size_t(l.columns) + size_t(column)]);
      if (depth == 0) continue;
      const double beta = -(column - l.columns / 2.0) / l.columns * 2 * M_PI;
      const double alpha = (l.up_deg - double(row) / l.rows * l.total_deg) * M_PI / 180;
      out.push_back((depth * Vec3(std::cos(alpha) * std::cos(beta),
                                  std::cos(alpha) * std::sin(beta), std::sin(alpha)))
                        .cast<float>());
    }
  }
  return out;
}

double structural_similarity(std::span<const float> a, std::span<const float> b, int rows,
                             int columns, double value_range) {
  require(rows >= kWindow && columns >= kWindow,
          "similarity: the images are smaller than a window");
  require(a.size() == b.size() && a.size() == size_t(rows) * size_t(columns),
          "similarity: the images differ in size");
  const double c1 = std::pow(0.01 * value_range, 2), c2 = std::pow(0.03 * value_range, 2);
  double sum = 0;
  for (int row = 0; row + kWindow <= rows; ++row) {
    for (int column = 0; column + kWindow <= columns; ++column) {
      WindowSums s;
      for (int y = row; y < row + kWindow; ++y) {
        const size_t at = size_t(y) * size_t(columns) + size_t(column);
        for (size_t x = at; x < at + kWindow; ++x) s.add(double(a[x]), double(b[x]));
      }
      sum += similarity(s, c1, c2);
    }
  }
  return sum / (double(rows - kWindow + 1) * double(columns - kWindow + 1));
}

ImageScores image_scores(const RangeImage& real, const RangeImage& simulated) {
  require(real.depth_m.size() == simulated.depth_m.size(), "images of different layouts");
  ImageScores out;
  score_clouds(points_of(real), points_of(simulated), out);
  score_drops(real, simulated, out);
  const double most = real.layout.max_range_m;
  const auto clamped = [&](float d) { return std::clamp(double(d), kLeastDepthM, most); };
  const size_t n = real.depth_m.size();
  std::vector<double> error(n);
  double squares = 0, intensity = 0, least = most, largest = 0;
  for (size_t k = 0; k < n; ++k) {
    const double depth = clamped(real.depth_m[k]);
    error[k] = std::abs(depth - clamped(simulated.depth_m[k]));
    squares += error[k] * error[k] / double(n);
    intensity +=
        std::pow(double(real.intensity[k]) - double(simulated.intensity[k]), 2) / double(n);
    least = std::min(least, depth);
    largest = std::max(largest, depth);
  }
  // The median of an even number of values is the mean of the middle two.
  const auto middle = error.begin() + std::ptrdiff_t(n / 2);
  std::nth_element(error.begin(), middle, error.end());
  out.depth_median_m = n % 2 ? *middle : 0.5 * (*middle + *std::max_element(error.begin(), middle));
  out.depth_rmse_m = std::sqrt(squares);
  out.depth_psnr = 10 * std::log10(most * most / squares);
  out.intensity_rmse = std::sqrt(intensity);
  out.depth_ssim = structural_similarity(real.depth_m, simulated.depth_m, real.layout.rows,
                                         real.layout.columns, largest - least);
  return out;
}

ProtocolScores range_image_scores(BeamSource& real, BeamSource& simulated,
                                  const RangeImageLayout& layout) {
  ProtocolScores out;
  bool intensities = false;
  for_each_scan(real, simulated, [&](const BeamLog& a, const BeamLog& b) {
    const ImageScores s = image_scores(range_image(a, layout), range_image(b, layout));
    for (const auto field : kFields) out.mean.*field += s.*field;
    out.empty_share += empty_share(a, layout);
    intensities |=
        std::any_of(b.intensity.begin(), b.intensity.end(), [](float x) { return x > 0; });
    ++out.scans;
  });
  for (const auto field : kFields) out.mean.*field /= double(out.scans);
  out.empty_share /= double(out.scans);
  if (!intensities) out.mean.intensity_rmse = NAN;
  return out;
}

}  // namespace underbrush::metrics
