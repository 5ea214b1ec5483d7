/// Colours and pictures of beams: points seen from above, and range images of one scan.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/io/image.hpp"

namespace underbrush::report {

using Rgb = std::array<uint8_t, 3>;

inline constexpr Rgb kBackground{14, 17, 22};
inline constexpr Rgb kMissColour{44, 49, 58};   ///< A beam without a return.
inline constexpr Rgb kFalseHit{255, 214, 10};   ///< Simulated a return where there was none.
inline constexpr Rgb kFalseMiss{46, 230, 168};  ///< Simulated none where there was one.
inline constexpr double kErrorScale = 1.0;      ///< m; range errors beyond have the end colours.

/// Dark blue (0) over green to yellow (1), in 48 steps; clamped.
Rgb scale_colour(double fraction);
/// Blue (too near) over grey to red (too far), ±`kErrorScale`.
Rgb error_colour(double error_m);

/// The world seen from above, x to the right and y up.
struct TopView {
  Vec3 corner = Vec3::Zero();  ///< m, world: the upper left corner of the picture.
  double metres_per_pixel = 1;
  int width = 1, height = 1;  ///< Pixels.
};

/// Points from above into a picture: of those on one pixel the highest is seen.
class TopPicture {
 public:
  explicit TopPicture(const TopView& view);
  void add(const Vec3& point, Rgb colour);
  /// The same with empty pixels between points filled from the highest neighbour.
  TopPicture closed() const;
  /// The picture, darkened beneath higher neighbours so that shapes stand out.
  io::Image image() const;

 private:
  TopView view_;
  std::vector<float> height_m_;
  std::vector<Rgb> colour_;
};

/// One beam of the scan that is shown as range images.
struct ScanBeam {
  Vec3f direction;  ///< Sensor frame.
  uint16_t ring;
  float real_m;                 ///< `kMiss` for none.
  std::vector<float> ranges_m;  ///< Of each simulated log.
};

/// Where each beam of a scan lies in a picture of ring (highest on top) by azimuth (left to right
/// as seen from the sensor); where several beams share a pixel the first is shown in all pictures.
struct ScanLayout {
  int columns = 0, rows = 0;
  std::vector<int> beam;  ///< columns·rows, −1 for none.
  bool by_ring = true;    ///< False: rows of equal elevation, where the log has no rings.
};
ScanLayout layout_of(const std::vector<ScanBeam>& scan);

/// Ranges of simulated log `k`, or of the real one (k = −1); nearest dark, up to `far_m`.
io::Image range_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k,
                      double far_m);
/// Range errors of simulated log `k`.
io::Image error_image(const std::vector<ScanBeam>& scan, const ScanLayout& layout, int k);

/// `data:` address of the picture as PNG.
std::string data_url(const io::Image& image);
/// Base64 of `n` bytes.
std::string base64(const void* bytes, size_t n);

}  // namespace underbrush::report
