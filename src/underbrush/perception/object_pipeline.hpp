/// \file
/// This file has a real processing of point clouds to object lists, which uses no ground truth. It
/// stands for the unknown software of a sensor ([rosenberger20] §5).
#pragma once
#include <vector>

#include "underbrush/perception/assignment.hpp"
#include "underbrush/perception/classification.hpp"
#include "underbrush/perception/cloud.hpp"
#include "underbrush/perception/clusters.hpp"
#include "underbrush/perception/objects.hpp"
#include "underbrush/perception/segment_shape.hpp"
#include "underbrush/perception/track.hpp"

namespace underbrush::perception {

/// The options of `ObjectPipeline`.
struct PipelineOptions {
  ClusterOptions clusters;
  ShapeOptions shape;
  ClassificationOptions classification;
  TrackOptions track;
  /// m; a segment this far from the predicted place of a track is not assigned to it. The gate
  /// grows by two standard deviations of the track's position.
  double gate_m = 1.5;
  double most_gate_m = 4;
  double latency_s = 0;  ///< Time from the cloud to its list.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// Ground removal, clustering, L-shape, joining of parts, assignment at the least sum of distances,
/// and the track management of the tracking model. Its state is a plain value, and it allocates no
/// memory after the first cycles, as long as there are no more points, clusters or objects (with
/// the ground method "cone").
class ObjectPipeline {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit ObjectPipeline(const PipelineOptions& options = {});
  /// Processes a cycle. Times must ascend, as for `TrackingModel`.
  void step(const MergedCloud& cloud, ObjectList& list);
  /// Forgets all objects.
  void reset();
  /// The clusters of the last cycle.
  const Segments& segments() const { return segments_; }

 private:
  /// A cluster: its box in the direction of its heading, which may be turned by quarters.
  struct Candidate {
    std::optional<double> heading_rad;
    SegmentShape shape;
  };
  void find_candidates(const MergedCloud& cloud);
  Candidate measured(size_t segment);
  /// Gives the points of each segment whose centre lies in the footprint of a larger one to that
  /// one, and returns whether there are such segments.
  bool join_parts();
  void assign();
  void update(Track& track, uint32_t candidate);
  void begin_tracks();
  double first_heading(const Candidate& candidate) const;
  bool is_across(const Candidate& candidate, double yaw_rad) const;
  int first_heading_turns(const Candidate& candidate, double yaw_rad) const;

  PipelineOptions options_;
  Clusters clusters_;
  ShapeFitter shapes_;
  Classification classification_;
  Assignment assignment_;
  std::vector<Track> tracks_;  ///< In order of id.
  uint64_t next_id_ = 1;
  double time_s_ = 0, vehicle_yaw_rad_ = 0;
  Vec3 viewpoint_ = Vec3::Zero();
  std::vector<Vec3> points_;
  Segments segments_;
  std::vector<Candidate> candidates_;
  std::vector<uint32_t> whole_, number_;
  std::vector<uint8_t> has_parts_, taken_;
  std::vector<double> cost_;
};

}  // namespace underbrush::perception
