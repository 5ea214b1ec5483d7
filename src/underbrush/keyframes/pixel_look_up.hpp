/// \file
/// The look-up of several beams at once in one keyframe.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "underbrush/elements/keyframes.hpp"

namespace underbrush::keyframes {

/// Beams to look up in one keyframe, and the pixels found.
struct PixelLookUp {
  static constexpr size_t kBeams = 8, kFound = elements::Keyframes::kPixelsOfFrame;
  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr float kLeastRangeM = 0.1f;  ///< The least range of a pixel that is found.

  struct Vectors {
    std::array<float, kBeams> x, y, z;
  };

  Vectors from;       ///< Origins relative to the keyframe's, m.
  Vectors direction;  ///< Unit vectors (world).
  /// Numbers of the pixels, the one at the smallest angle first; `kNone` where there are fewer.
  std::array<std::array<uint32_t, kBeams>, kFound> pixel;
};

/// A keyframe, ready for `look_up_pixels`.
struct LookUpFrame {
  std::array<float, 9> sensor_from_world;  ///< Row by row.
  const Vec3f* column_origin;              ///< m
  const elements::KeyframePixel* pixels;
};

/// The grid of keyframes, ready for `look_up_pixels`.
class LookUpGrid {
 public:
  /// `keyframes` must outlive the frames.
  explicit LookUpGrid(const elements::Keyframes& keyframes);

  int32_t rows, columns;
  float unit_m, columns_a_rad, column_rad;
  float lowest, highest;         ///< rad; half a row beyond the image's outermost rows.
  std::vector<float> elevation;  ///< rad, of the rows.
  float first, slots_a_rad;
  /// The last row not above an angle, by the angle, or up to `steps` rows below it.
  std::vector<int32_t> row_below;
  int32_t steps = 0;
  std::vector<LookUpFrame> frames;
};

/// Finds the pixels of a keyframe whose points lie on beams from elsewhere.
///
/// The point is found by fixed-point iteration: the pixel in the direction of a point on the beam
/// gives the next point, until the pixel stays the same. The result is the four pixels nearest to
/// that direction among the nine about it. The results do not depend on the instruction set, and
/// that of a beam not on the other beams.
void look_up_pixels(const LookUpGrid& grid, const LookUpFrame& frame, PixelLookUp& beams);

}  // namespace underbrush::keyframes
