/// \file
/// An object of a site: its class, pose and box.
#pragma once
#include <array>
#include <cmath>
#include <filesystem>

#include "underbrush/core/pose.hpp"
#include "underbrush/elements/classes.hpp"

namespace underbrush::primitives {

/// A box in an object's frame (m).
struct Box {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();
  Vec3 size() const { return max - min; }
};

/// The beams of a log in an object's box, by thirds of its height from the bottom up. All values
/// are 0 where they are not known.
struct BoxBeams {
  std::array<double, 3> returns{};  ///< Number of beams that ended there at the object.
  std::array<double, 3> path_m{};   ///< m; the length of all beams there, up to their returns.

  bool known() const { return path_m[0] + path_m[1] + path_m[2] > 0; }
};

/// Where the points of an object lie (m, object's frame), in five layers of as many points each
/// from the bottom up. All values are 0 where they are not known.
struct PointLayers {
  static constexpr std::array<double, 5> kShares{0.1, 0.3, 0.5, 0.7, 0.9};
  using Places = std::array<double, kShares.size()>;

  Places z{};  ///< The median height of each layer: the quantiles of all heights at `kShares`.
  /// For each layer, the quantiles of the coordinate at `kShares`.
  std::array<Places, kShares.size()> x{}, y{};

  bool known() const { return *this != PointLayers{}; }
  bool operator==(const PointLayers&) const = default;
};

/// An object (c, q, box) of [tallavajhula18] §IV. Its pose stands on the ground under the centroid
/// of the object's points and is turned about z alone, with x along the longer principal axis of
/// the points seen from above. The bottom of the box is the ground (z = 0).
struct PlacedObject {
  elements::Class label = elements::Class::kUnknown;
  Vec3 position = Vec3::Zero();  ///< m, world.
  double yaw_rad = 0;
  Box box;
  uint32_t instance = 0;  ///< Number in the labelled log, 0 = none. The cells of a patch share it.
  size_t points = 0;      ///< Number of points that it was measured from.
  PointLayers layers;
  BoxBeams beams;
  /// File of the poses of the foot over time (TUM, world from object), for an object that moves;
  /// empty if it stands still.
  std::filesystem::path trajectory;

  Pose world_from_object() const {
    return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())), position};
  }
};

/// Rounds a length (m) to the millimetre, as files store it; measurements are no more exact.
inline double as_written(double x) { return std::round(x * 1000) / 1000; }
/// Rounds a position (m) to the millimetre.
inline Vec3 as_written(const Vec3& v) { return (v * 1000).array().round() / 1000; }
/// Rounds the corners of a box to the millimetre.
inline Box as_written(const Box& box) { return {as_written(box.min), as_written(box.max)}; }
/// Rounds an object's position and box to the millimetre and its heading to 0.01 mrad.
inline PlacedObject as_written(PlacedObject o) {
  o.position = as_written(o.position);
  o.yaw_rad = std::round(o.yaw_rad * 1e5) / 1e5;
  o.box = as_written(o.box);
  return o;
}

}  // namespace underbrush::primitives
