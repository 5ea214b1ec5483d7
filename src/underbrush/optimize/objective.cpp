#include "underbrush/optimize/objective.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::optimize {

std::vector<std::string> objectives() { return {"packet_f1", "nll"}; }

double objective_of(const std::string& name, const metrics::Summary& s, double max_range_m) {
  if (name == "nll") {
    require(std::isfinite(s.nll_per_beam), "optimize: the scores have no likelihood");
    return s.nll_per_beam;
  }
  if (name != "packet_f1") throw std::invalid_argument("optimize: no objective '" + name + "'");
  const double packet = std::isfinite(s.packet_error_m) ? s.packet_error_m : max_range_m;
  return packet + 2 * (1 - (std::isfinite(s.f1) ? s.f1 : 0));
}

Outcome outcome_of(const std::string& objective, const trace::World& world, const BeamLog& beams,
                   uint64_t seed) {
  BeamLog answered = beams;
  simulate::Options simulate;
  simulate.seed = seed;
  simulate::simulate(world, simulate, 0, answered);
  MemorySource real(beams), simulated(answered);
  metrics::ScoreOptions score;
  score.cloud = false;
  if (objective == "nll") score.world = &world;
  const metrics::Summary s = metrics::score(real, simulated, score).all;
  Outcome out{objective_of(objective, s, beams.info.max_range_m),
              {{"packet_error_m", s.packet_error_m},
               {"precision", s.precision},
               {"recall", s.recall},
               {"f1", s.f1}}};
  if (score.world) {
    out.score["nll_per_beam"] = s.nll_per_beam;
    out.score["crps_m"] = s.crps_m;
  }
  return out;
}

Outcome fit_outcome(const std::string& objective, const Slice& slice,
                    const fit::FitOptions& options) {
  MemorySource source(slice.fit);
  const fit::FitResult fitted = fit::fit(source, options);
  const trace::World world(fitted.model);
  return outcome_of(objective, world, slice.validation, options.seed);
}

}  // namespace underbrush::optimize
