/// \file
/// The labelled objects of a real log: the log without them, and models of them.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/perception/log_truth.hpp"

namespace underbrush::studies {

/// A labelled object over time, as the sensor saw it.
struct ObjectTrack {
  uint64_t id = 0;
  perception::ObjectClass label = perception::ObjectClass::kUnknown;
  Vec3 size_m = Vec3::Zero();
  std::vector<perception::SeenBox> seen;  ///< In order of time.
};

/// Sorts the labelled boxes by object.
std::vector<ObjectTrack> tracks_of(const perception::LogTruth& truth);

/// The beams of every n-th scan of a log, without those that end in a labelled object or within
/// 0.4 m of it.
class StaticBeams : public BeamSource {
 public:
  StaticBeams(BeamSource& log, const std::vector<ObjectTrack>& tracks, uint32_t every_nth);
  const LogInfo& info() const override { return log_.info(); }
  size_t size() const override { return log_.size(); }
  void rewind() override { log_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& log_;
  const std::vector<ObjectTrack>& tracks_;
  uint32_t every_nth_;
};

/// Fits ellipsoids to the points of each object in the scans with even numbers, in the frame of its
/// box. An object with fewer than 30 points has a mesh (`road_user`) instead.
std::vector<elements::Model> models_of_points(BeamSource& log,
                                              const std::vector<ObjectTrack>& tracks,
                                              uint64_t seed);
/// Makes a mesh for each object.
std::vector<elements::Model> meshes_of(const std::vector<ObjectTrack>& tracks);

}  // namespace underbrush::studies
