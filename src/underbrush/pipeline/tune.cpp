#include "underbrush/pipeline/tune.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/optimize/densities.hpp"
#include "underbrush/optimize/fit_parameters.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/score_logs.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::pipeline {

using optimize::Outcome;

Outcome outcome_of(const std::string& objective, const TracedWorld& world, const BeamLog& beams,
                   uint64_t seed) {
  SimulateOptions options;
  options.seed = seed;
  Simulation simulation(world, options);
  const BeamLog answered = simulate_log(simulation, beams);
  MemorySource real(beams), simulated(answered);
  const bool likelihood = objective == "nll";
  const metrics::Summary s = score_logs(real, simulated, likelihood ? &world : nullptr, false).all;
  Outcome out{optimize::objective_of(objective, s, beams.info.max_range_m),
              {{"packet_error_m", s.packet_error_m},
               {"precision", s.precision},
               {"recall", s.recall},
               {"f1", s.f1}}};
  if (likelihood) {
    out.score["nll_per_beam"] = s.nll_per_beam;
    out.score["crps_m"] = s.crps_m;
  }
  return out;
}

TuningProblem tuned_fit(const std::string& objective, std::shared_ptr<const optimize::Slice> slice,
                        const fit::FitOptions& options, std::span<const std::string> names) {
  const std::vector<optimize::FitParameter> chosen =
      optimize::chosen_fit_parameters(options, names);
  TuningProblem out;
  out.parameters.assign(chosen.begin(), chosen.end());
  for (const auto& parameter : chosen) out.start.push_back(number_of(*parameter.of, options));
  out.objective = [objective, options, chosen,
                   slice = std::move(slice)](std::span<const double> value) {
    fit::FitOptions tried = options;
    for (size_t k = 0; k < value.size(); ++k) set_number(*chosen[k].of, tried, value[k]);
    MemorySource source(slice->fit);
    const FittedModel fitted = fit_model({source}, tried);
    return outcome_of(objective, TracedWorld(fitted.model), slice->validation, tried.seed);
  };
  return out;
}

TuningProblem tuned_scene(const std::string& objective, std::shared_ptr<const SceneParts> parts,
                          BeamLog beams, uint64_t seed, std::span<const std::string> names) {
  const std::vector<optimize::Parameter> all = optimize::density_parameters(parts->annotation);
  require_data(!all.empty(),
               "optimize: the annotation has no objects, so there is no density to tune");
  TuningProblem out;
  for (const size_t k : optimize::chosen(all, names)) out.parameters.push_back(all[k]);
  out.start.assign(out.parameters.size(), 1);
  out.objective = [objective, parts = std::move(parts), beams = std::move(beams), seed,
                   densities = out.parameters](std::span<const double> value) {
    primitives::ComposeOptions options;
    options.seed = seed;
    for (size_t k = 0; k < densities.size(); ++k) {
      options.density[*elements::class_from_name(densities[k].name)] = value[k];
    }
    const primitives::Composition composed =
        primitives::compose(parts->annotation, parts->ground, parts->primitives, options);
    return outcome_of(objective, TracedWorld(composed.scene, composed.info), beams, seed);
  };
  return out;
}

}  // namespace underbrush::pipeline
