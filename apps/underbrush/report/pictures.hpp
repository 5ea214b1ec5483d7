/// Pictures of a log and of what a simulation makes of it.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/io/image.hpp"

namespace underbrush::app {

using Colour = std::array<uint8_t, 3>;

/// Of a range error (m): blue where the simulation is too near, grey where it agrees, red where it
/// is too far; saturated at ±`kErrorSpan`.
inline constexpr double kErrorSpan = 2.0;
Colour colour_of_error(double error_m);
inline constexpr Colour kFalseHit{214, 39, 190}, kFalseMiss{240, 180, 0};
/// Of a value in [0, 1], dark to bright.
Colour colour_of_level(double level);

/// A view from above: points drawn in order of height.
class BirdsEye {
 public:
  /// Covers [lo, hi] (m, world) with an image at most `pixels` wide or high.
  BirdsEye(const Eigen::Vector2d& lo, const Eigen::Vector2d& hi, int pixels);
  void draw(const Vec3& point, Colour colour);
  /// Colours by height between the given heights (m).
  void draw_height(const Vec3& point, double low, double high);
  const io::Image& image() const { return image_; }
  double metres_per_pixel() const { return metres_per_pixel_; }

 private:
  Eigen::Vector2d lo_;
  double metres_per_pixel_;
  io::Image image_;
  std::vector<float> height_;
};

/// One scan as an image: ring by azimuth in `columns`, top ring first, forward in the middle.
class RangeImage {
 public:
  RangeImage(const Pose& world_from_sensor, int columns, int rings, bool top_ring_is_zero);
  /// Paints the beam's cell.
  void draw(const BeamLog& log, size_t beam, Colour colour);
  const io::Image& image() const { return image_; }

 private:
  Pose sensor_from_world_;
  int rings_;
  bool top_ring_is_zero_;
  io::Image image_;
};

}  // namespace underbrush::app
