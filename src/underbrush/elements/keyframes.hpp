/// \file
/// Keyframes: range images of the measurements of a sensor from some places of a log, kept in a
/// model so that simulations near these places answer as the sensor did there.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::elements {

/// A pixel of a keyframe: where a beam ended, and its intensity, in the units of `Keyframes`.
struct KeyframePixel {
  static constexpr int16_t kUnknown = INT16_MIN, kNoReturn = INT16_MIN + 1;  ///< Values of `x`.
  static constexpr int kMost = INT16_MAX;

  int16_t x = kUnknown, y = 0, z = 0;
  uint16_t intensity = 0;

  bool is_unknown() const { return x == kUnknown; }
  bool is_miss() const { return x == kNoReturn; }
  bool is_hit() const { return x > kNoReturn; }
};

/// One scan as a range image.
struct Keyframe {
  Vec3 origin = Vec3::Zero();  ///< m, relative to the model's origin; the mean of the beams'.
  Eigen::Quaterniond sensor_from_world = Eigen::Quaterniond::Identity();
  /// Origins of the columns' beams relative to `origin` (m, axes of the world), because the sensor
  /// moves while it turns.
  std::vector<Vec3f> column_origin;
  std::vector<KeyframePixel> pixels;  ///< Row by row; end points are relative to `origin`.
};

/// The weights of keyframes in one situation. The range of a beam then has the mixture distribution
///
///   w N_model + Σ_k r_k Σ_s c_s N(z_k, σ_s²)
///
/// where N_model is the distribution under the elements, and z_k are the ranges of the pixels found
/// along the beam; a pixel without a return stands for a miss. The weights w and r_k sum to 1, and
/// so do the c_s. The weight of a pixel that is unknown goes to the elements.
struct KeyframeWeights {
  static constexpr size_t kPixels = 8, kScales = 3;
  double elements = 1;                                  ///< w
  std::array<double, kPixels> pixel{};                  ///< r_k
  std::array<double, kScales> scale{};                  ///< c_s
  std::array<double, kScales> sigma_m{0.02, 0.1, 0.5};  ///< σ_s, m
};

/// The keyframes of a log.
struct Keyframes {
  /// Number of keyframes that are queried for one beam, and of pixels in each of them.
  static constexpr size_t kFrames = 2, kPixelsOfFrame = KeyframeWeights::kPixels / kFrames;
  /// A situation is an interval of the distance to the nearest keyframe and a class of the
  /// agreement of the pixels (`agreement`). These are the upper bounds of the intervals (m); beyond
  /// the last one keyframes are not used.
  static constexpr std::array<double, 6> kDistances{0.05, 0.3, 0.8, 1.6, 4, 8};
  static constexpr size_t kAgreements = 7, kSituations = kDistances.size() * kAgreements;

  std::vector<double> elevation;  ///< Elevations of the rows in the sensor's frame, rad, ascending.
  /// The sensor's channels of the rows; empty where the log has none. Directions between the rows
  /// are unknown, so beams of other channels are not answered.
  std::vector<uint16_t> channel;
  size_t columns = 0;         ///< Number of equal steps of azimuth over the whole turn.
  double unit_m = 0;          ///< Step of a pixel's coordinates, m.
  double intensity_unit = 0;  ///< Intensity of a step; 0 where the log has none.
  std::vector<Keyframe> frames;
  std::array<KeyframeWeights, kSituations> weights;

  size_t rows() const { return elevation.size(); }
  size_t pixels() const { return rows() * columns; }
  /// Returns a pixel's end point relative to its keyframe's origin, m; of a hit only.
  Vec3 point(const KeyframePixel& p) const {
    return unit_m * Vec3(double(p.x), double(p.y), double(p.z));
  }
  /// Throws `std::invalid_argument` where sizes do not fit, a value is not finite, a weight is
  /// negative or weights do not sum to 1.
  void check() const;
};

/// Classifies the agreement of the ranges (m; infinite for a miss) of the pixels found for a beam.
/// The result is 0 if no pixel has a return, 1 if most have none, and 2 if some have none. If all
/// have one, it is 3, 4 or 5 for ranges within 0.15, 0.5 or 2 m of each other, else 6.
size_t agreement(const double* range_m, size_t count);

/// The places of directions in the keyframes' image. Angles are those of the sensor's frame; its x
/// axis has the azimuth 0. Their error is below 10⁻⁵ rad.
class KeyframeGrid {
 public:
  struct Place {
    double row, column;  ///< Pixel k has its middle at k + ½; a row off the image is negative.
  };

  /// `keyframes` must outlive it.
  explicit KeyframeGrid(const Keyframes& keyframes);
  /// Finds the place of a direction of any length in the sensor's frame.
  Place place(const Vec3& direction) const;
  /// The elevation (rad) of a place on the image.
  double elevation(double row) const;

 private:
  const std::vector<double>& elevation_;
  double columns_a_rad_, first_, per_rad_;
  double columns_;
  std::vector<uint32_t> row_below_;  ///< The last row not above an angle, by the angle.
};

}  // namespace underbrush::elements
