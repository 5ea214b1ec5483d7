#include "studies/moving_objects.hpp"

#include <algorithm>

#include "studies/car_mesh.hpp"
#include "underbrush/pipeline/learn_actors.hpp"

namespace underbrush::studies {

MarkedScans::MarkedScans(BeamSource& log, const std::vector<actors::Track>& tracks,
                         uint32_t every_nth)
    : log_(log), boxes_(tracks, {}), every_nth_(every_nth) {}

bool MarkedScans::next(BeamLog& chunk) {
  BeamLog all;
  if (!log_.next(all)) return false;
  chunk = all.like();
  for (size_t i = 0; i < all.size(); ++i) {
    if (all.scan[i] % every_nth_ == 0) chunk.append(all, i);
  }
  actors::mark_returns(boxes_, chunk);
  return true;
}

std::vector<elements::Model> learnt_models(BeamSource& log,
                                           const std::vector<actors::Track>& tracks,
                                           uint64_t seed) {
  actors::ActorOptions options;
  options.poses_as_given = true;  // The tracer places a model where the box is,
  options.walk_s = 1e6;           // and has one model for each object.
  MarkedScans scans(log, tracks, 2);
  std::vector<actors::Actor> learnt =
      pipeline::learn_actors(scans, "log", tracks, options, seed).actors;
  std::vector<elements::Model> models = meshes_of(tracks);
  for (size_t k = 0; k < tracks.size(); ++k) {
    const auto own = std::ranges::find(learnt, tracks[k].name(), &actors::Actor::name);
    if (own != learnt.end()) models[k] = std::move(own->model);
  }
  return models;
}

std::vector<elements::Model> meshes_of(const std::vector<actors::Track>& tracks) {
  std::vector<elements::Model> models;
  models.reserve(tracks.size());
  for (const actors::Track& t : tracks) models.push_back(road_user(t.label, t.size_m));
  return models;
}

}  // namespace underbrush::studies
