#include "underbrush/pipeline/tune.hpp"

#include <memory>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/optimize/densities.hpp"
#include "underbrush/optimize/fit_parameters.hpp"
#include "underbrush/pipeline/compose_scene.hpp"
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
  const metrics::Summary s =
      score_log(real, simulated, likelihood ? &world : nullptr, {.cloud = false}).all;
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

TuningProblem tuned_fit(BeamSource& log, const optimize::TuneOptions& options,
                        const fit::FitOptions& fit) {
  const std::vector<optimize::FitParameter> chosen =
      optimize::chosen_fit_parameters(fit, options.tune);
  const auto slice =
      std::make_shared<const optimize::Slice>(optimize::take_slice(log, options.cut()));
  TuningProblem out;
  out.slice = slice->facts();
  out.parameters.assign(chosen.begin(), chosen.end());
  for (const auto& parameter : chosen) out.start.push_back(number_of(*parameter.of, fit));
  out.objective = [objective = options.objective, fit, chosen,
                   slice](std::span<const double> value) {
    fit::FitOptions tried = fit;
    for (size_t k = 0; k < value.size(); ++k) set_number(*chosen[k].of, tried, value[k]);
    MemorySource source(slice->fit);
    const FittedModel fitted = fit_model({source}, tried);
    return outcome_of(objective, TracedWorld(fitted.model), slice->validation, tried.seed);
  };
  return out;
}

SceneParts read_scene_parts(const std::filesystem::path& annotation, const std::string& primitives,
                            bool allow_outside, uint64_t seed) {
  SceneParts out;
  out.annotation = primitives::read_annotation(annotation, allow_outside);
  if (out.annotation.objects.empty()) {
    throw FormatError(annotation.string(), "", "no objects: there is no density to tune");
  }
  out.ground = elements::read_model(out.annotation.ground.lexically_normal());
  NamedSet named = primitives_named(primitives, seed);
  out.primitives = std::move(named.set);
  out.inputs = {annotation, out.annotation.ground.lexically_normal()};
  out.inputs.insert(out.inputs.end(), named.inputs.begin(), named.inputs.end());
  out.warnings = std::move(named.warnings);
  return out;
}

TuningProblem tuned_scene(BeamSource& log, const optimize::TuneOptions& options, SceneParts parts) {
  optimize::Slice slice = optimize::take_slice(log, options.cut());
  TuningProblem out;
  out.slice = slice.facts();
  out.inputs = parts.inputs;
  out.warnings = parts.warnings;
  BeamLog beams = std::move(slice.fit);
  beams.append(slice.validation, 0, slice.validation.size());
  const std::vector<optimize::Parameter> all = optimize::density_parameters(parts.annotation);
  for (const size_t k : optimize::chosen(all, options.tune)) out.parameters.push_back(all[k]);
  out.start.assign(out.parameters.size(), 1);
  out.objective =
      [objective = options.objective, seed = options.seed, densities = out.parameters,
       beams = std::make_shared<const BeamLog>(std::move(beams)),
       of = std::make_shared<const SceneParts>(std::move(parts))](std::span<const double> value) {
        primitives::ComposeOptions compose;
        compose.seed = seed;
        for (size_t k = 0; k < densities.size(); ++k) {
          compose.density[*elements::class_from_name(densities[k].name)] = value[k];
        }
        const primitives::Composition composed =
            primitives::compose(of->annotation, of->ground, of->primitives, compose);
        return outcome_of(objective, TracedWorld(composed.scene, composed.info), *beams, seed);
      };
  return out;
}

std::vector<optimize::Evaluation> tune(
    const TuningProblem& problem, const optimize::TuneOptions& options,
    const std::vector<optimize::Evaluation>& past,
    const std::function<void(std::span<const optimize::Evaluation>)>& after) {
  return optimize::search(problem.parameters, problem.start, options.search, problem.objective,
                          past, after);
}

}  // namespace underbrush::pipeline
