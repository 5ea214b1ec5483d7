#include "underbrush/pipeline/learn_actors.hpp"

#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::pipeline {

actors::LearntActors learn_actors(BeamSource& log, const std::string& file,
                                  const std::vector<actors::Track>& tracks,
                                  const actors::ActorOptions& options, uint64_t seed,
                                  const std::function<void(size_t, size_t)>& progress) {
  fit::FitOptions fit;
  fit.seed = seed;
  fit.segment.method = "none";
  fit.keyframes.spacing_m = 0;
  fit.unknown_cell_m = 0;
  fit.free_space_below = 0;  // A part that few views show is no free space.
  fit.ranges_as_given = true;
  const auto model_of = [&](const BeamLog& beams) {
    MemorySource source(beams);
    return fit_model({source}, fit).model;
  };
  actors::LearntActors out = actors::learn_actors(log, tracks, options, model_of, progress);
  if (out.actors.empty()) throw FormatError(file, "", "all tracks have too few returns");
  return out;
}

nlohmann::ordered_json json_of(const actors::LearntActors& learnt) {
  nlohmann::ordered_json j{{"actors", nlohmann::ordered_json::array()}};
  for (const actors::ActorReport& r : learnt.report) {
    j["actors"].push_back({{"name", r.name},
                           {"class", r.label},
                           {"scans", r.scans},
                           {"returns", r.returns},
                           {"passed", r.passed},
                           {"mirrored", r.mirrored},
                           {"models", r.models},
                           {"apart_as_given_m", r.views.before_m},
                           {"apart_m", r.views.after_m}});
  }
  return j;
}

std::string with_report(const std::string& provenance, const actors::LearntActors& learnt) {
  nlohmann::ordered_json j = io::json_of_text(provenance);
  j.update(json_of(learnt));
  return io::text_of_json(j, -1);
}

}  // namespace underbrush::pipeline
