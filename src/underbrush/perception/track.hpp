/// \file
/// This file has a track: the state of one object from cycle to cycle. The tracking model and the
/// real pipeline share it.
#pragma once
#include <array>
#include <cstdint>

#include "underbrush/perception/classification.hpp"
#include "underbrush/perception/existence.hpp"
#include "underbrush/perception/motion_filter.hpp"
#include "underbrush/perception/segment_shape.hpp"
#include "underbrush/perception/size_prior.hpp"

namespace underbrush::perception {

/// The point of an object that is tracked, [rosenberger20] §3.3.
enum class ReferencePoint : uint8_t {
  kCentreOfGravity,  ///< The mean of its points.
  kGeometricCentre,  ///< The centre of its box.
  kCorner,           ///< The corner of its box that is nearest to the viewpoint.
};

/// The options of a track.
struct TrackOptions {
  ReferencePoint reference = ReferencePoint::kCorner;
  ExistenceOptions existence;
  MotionOptions motion;
  CompletionOptions completion;
  /// Cycles over which extents are averaged; at most `kMostWindow`.
  int size_window = 3;
  /// m; the reported length, width and height are at least these.
  Vec3 least_size_m{0, 0, 0};
  /// m; the heading of an object that has moved so far is that of its motion.
  double heading_distance_m = 1.5;

  static constexpr int kMostWindow = 8;
  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The state of one object. It is a plain value.
struct Track {
  uint64_t id = 0, truth_id = 0;
  ObjectClass label = ObjectClass::kUnknown;
  ClassEvidence evidence;
  std::array<float, kClassCount> probability{};
  Existence existence;
  MotionFilter filter;
  double begin_s = 0;     ///< Time of the first measurement.
  double last_s = 0;      ///< Time of the filter's state.
  double measured_s = 0;  ///< Time of the last measurement.
  uint32_t points = 0;
  bool is_measured = false;
  uint32_t measurements = 0;
  std::array<std::array<Vec3, TrackOptions::kMostWindow>, 3> window;  ///< Measured, whole, σ.
  Vec3 measured_m = Vec3::Zero(), size_m = Vec3::Zero(), size_sigma_m = Vec3::Zero();
  /// Centre of the box less the reference point, in the frame of the box.
  Vec3 offset_m = Vec3::Zero();
  Vec3 measured_offset_m = Vec3::Zero();  ///< The `offset_m` of the box around the points alone.
  std::array<int, 2> corner{1, 1};        ///< Signs of the tracked corner in the frame of the box.
  Vec3 anchor_m = Vec3::Zero();  ///< Place of the object when its direction was last compared.

  /// Moves the state to a time. Until a measurement follows, the track is not measured.
  void predict(const TrackOptions& options, double time_s);
  /// Takes a measured segment. `heading_rad` is its direction, if it has one; the shape was
  /// measured in that direction, or in `hint_rad`.
  void measure(const TrackOptions& options, const SegmentShape& shape,
               std::optional<double> heading_rad, double hint_rad);
  /// Sets the filter's heading to the nearest quarter turn of the direction in which the object has
  /// moved, as soon as it has moved far enough. A car that drives backwards is therefore tracked as
  /// if it drove forwards, because its points are the same.
  void follow_motion(const TrackOptions& options);
  /// Turns the heading by quarter turns; the box stays, with its sides in other roles.
  void turn(const TrackOptions& options, int quarters);
  /// The centre of the box around its points alone, for the state of the filter.
  Vec3 measured_centre_m() const;
  /// The state as an object of a list.
  TrackedObject reported() const;

 private:
  void add_extents(const TrackOptions& options, const SegmentShape& shape,
                   const CompletedBox& whole);
  Vec3 reference_of(const TrackOptions& options, const SegmentShape& shape,
                    const OrientedBox& whole);
};

}  // namespace underbrush::perception
