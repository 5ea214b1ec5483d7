/// Colours and pictures of beams: points seen from above, and range images of a scan.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/io/image.hpp"

namespace underbrush::report {

using Rgb = std::array<uint8_t, 3>;

inline constexpr Rgb kBackground{14, 17, 22};
inline constexpr Rgb kMissColour{44, 49, 58};  ///< A beam without a return.
/// The simulation has a return where there was none.
inline constexpr Rgb kFalseHit{255, 214, 10};
/// The simulation has no return where there was one.
inline constexpr Rgb kFalseMiss{46, 230, 168};
inline constexpr double kErrorScale = 1.0;  ///< m; larger range errors have the end colours.

/// Returns a colour from dark blue (0) over green to yellow (1), in 48 steps; values are clamped.
Rgb scale_colour(double fraction);
/// Returns a colour from blue (too near) over grey to red (too far), ±`kErrorScale`.
Rgb error_colour(double error_m);

/// The part of the world that a picture from above shows; x points right and y up.
struct TopView {
  Vec3 corner = Vec3::Zero();  ///< m, world; the upper left corner of the picture.
  double metres_per_pixel = 1;
  int width = 1, height = 1;  ///< In pixels.
};

/// Draws points from above; on each pixel the highest point is visible.
class TopPicture {
 public:
  explicit TopPicture(const TopView& view);
  void add(const Vec3& point, Rgb colour);
  /// Returns a picture in which empty pixels between points are filled from the highest neighbour.
  TopPicture closed() const;
  /// Returns the picture, darkened beneath higher neighbours so that shapes stand out.
  io::Image image() const;

 private:
  TopView view_;
  std::vector<float> height_m_;
  std::vector<Rgb> colour_;
};

/// A beam of the scan that is shown as range images.
struct ScanBeam {
  Vec3f direction;  ///< In the sensor's frame.
  uint16_t ring;
  float real_m;                 ///< m; `kMiss` for a miss.
  std::vector<float> ranges_m;  ///< m; one for each simulated log.
};

/// Places the beams of a scan in a picture of ring (highest on top) by azimuth (left to right as
/// seen from the sensor). Where several beams share a pixel, the first is shown in all pictures.
struct ScanLayout {
  int columns = 0, rows = 0;
  std::vector<int> beam;  ///< Index of the beam at each of columns·rows pixels, −1 for none.
  bool by_ring = true;    ///< False: rows of equal elevation, for logs without rings.
};
/// Computes the layout of a scan.
ScanLayout layout_of(const std::vector<ScanBeam>& scan);

/// Draws the ranges of simulated log `k`, or of the real log (k = −1), from dark (near) to `far_m`
/// (m).
io::Image range_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k,
                      double far_m);
/// Draws the range errors of simulated log `k`.
io::Image error_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k);

/// Returns the picture as a `data:` address with PNG.
std::string data_url(const io::Image& image);
/// Encodes `n` bytes in base64.
std::string base64(const void* bytes, size_t n);

}  // namespace underbrush::report
