/// \file
/// The verb `actors`: a log in, models with trajectories of the things that moved in it out.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "underbrush/actors/learn_actors.hpp"

namespace underbrush::pipeline {

/// Learns the actors of tracks (`actors::learn_actors`) with the models of `fit_model`, which have
/// neither ground, keyframes nor unknown space. Throws `FormatError` where all tracks are left out.
actors::LearntActors learn_actors(BeamSource& log, const std::string& file,
                                  const std::vector<actors::Track>& tracks,
                                  const actors::ActorOptions& options, uint64_t seed,
                                  const std::function<void(size_t, size_t)>& progress = {});

/// A provenance (a JSON object) with the member `actors`: the report of each track.
std::string with_report(const std::string& provenance, const actors::LearntActors& learnt);

}  // namespace underbrush::pipeline
