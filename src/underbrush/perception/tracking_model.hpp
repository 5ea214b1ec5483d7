/// \file
/// This file has the tracking simulation of [rosenberger20] §3.3: points are assigned to the
/// objects of the ground truth, and the state of each object comes from its points.
#pragma once
#include <vector>

#include "underbrush/perception/cloud.hpp"
#include "underbrush/perception/objects.hpp"
#include "underbrush/perception/resolution.hpp"
#include "underbrush/perception/segment_shape.hpp"
#include "underbrush/perception/segments.hpp"
#include "underbrush/perception/track.hpp"

namespace underbrush::perception {

/// The source of the heading of a box.
enum class HeadingSource : uint8_t {
  /// The points; the truth decides which side is the front. A segment without a heading of its own
  /// takes that of the truth.
  kPoints,
  kTruth,  ///< The truth, as in the model that the authors of [rosenberger20] published.
};

/// The options of `TrackingModel`.
struct TrackingOptions {
  BoxAssignmentOptions assignment;
  ResolutionOptions resolution;
  ShapeOptions shape;
  TrackOptions track;
  HeadingSource heading = HeadingSource::kPoints;
  double latency_s = 0;  ///< Time from the cloud to its list.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// The tracking simulation. Its state is a plain value: a copy continues as the original does.
/// After the first cycles it allocates no memory, as long as there are no more points or objects.
class TrackingModel {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit TrackingModel(const TrackingOptions& options = {});

  /// Processes a cycle. The truth is of the time of the cloud. Times must ascend; a cloud of the
  /// time of the last one, or of an earlier one, counts as a cycle in which no time has passed.
  /// Throws `std::invalid_argument` where two objects of the truth have the same id, or one has 0.
  void step(const MergedCloud& cloud, const TruthFrame& truth, ObjectList& list);
  /// Forgets all objects.
  void reset();

  /// The segments of the last cycle, one for each object of the truth.
  const Segments& segments() const { return segments_; }
  /// The pairs of objects that were one segment in the last cycle.
  const std::vector<MergedPair>& merged() const { return resolution_.merged(); }

 private:
  Track* find(uint64_t truth_id);
  Track& begin_track(const TruthObject& object);
  void make_segments(const MergedCloud& cloud, const TruthFrame& truth);
  void update(const TruthObject& object, size_t segment);
  void write(const MergedCloud& cloud, ObjectList& list) const;

  TrackingOptions options_;
  BoxAssignment assignment_;
  Resolution resolution_;
  ShapeFitter shapes_;
  std::vector<Track> tracks_;  ///< In order of the truth's id.
  uint64_t next_id_ = 1;
  double time_s_ = 0;
  Vec3 viewpoint_ = Vec3::Zero();
  std::vector<Vec3> points_;
  std::vector<uint64_t> ids_;
  std::vector<uint8_t> listed_;
  Segments segments_;
};

/// Moves the points of a cloud to the world's frame.
void to_world(const MergedCloud& cloud, std::vector<Vec3>& points);
/// The mean place of the sensors that made a cloud, in the world's frame.
Vec3 viewpoint_of(const MergedCloud& cloud);

}  // namespace underbrush::perception
