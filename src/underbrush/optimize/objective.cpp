#include "underbrush/optimize/objective.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

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

}  // namespace underbrush::optimize
