/// \file
/// The labelled objects of a real log: the log with their returns marked, and models of them.
#pragma once
#include <vector>

#include "underbrush/actors/track.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::studies {

/// Every n-th scan of a log, in which the returns of tracks are marked as moving (`kMover`), so
/// that a fit leaves them out.
class MarkedScans : public BeamSource {
 public:
  /// `log` and `tracks` must outlive it.
  MarkedScans(BeamSource& log, const std::vector<actors::Track>& tracks, uint32_t every_nth);
  const LogInfo& info() const override { return log_.info(); }
  size_t size() const override { return log_.size(); }
  void rewind() override { log_.rewind(); }
  bool next(BeamLog& chunk) override;

 private:
  BeamSource& log_;
  actors::BoxesOfBeams boxes_;
  uint32_t every_nth_;
};

/// Learns a model of each object from the scans with even numbers, as the verb `actors` does, in
/// the frame of its box. An object that is left out there has a mesh (`road_user`) instead.
std::vector<elements::Model> learnt_models(BeamSource& log,
                                           const std::vector<actors::Track>& tracks, uint64_t seed);
/// Makes a mesh for each object.
std::vector<elements::Model> meshes_of(const std::vector<actors::Track>& tracks);

}  // namespace underbrush::studies
