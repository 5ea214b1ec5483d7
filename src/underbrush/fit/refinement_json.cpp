#include "underbrush/fit/refinement_json.inl"

#include <nlohmann/json.hpp>

namespace underbrush::fit {

nlohmann::ordered_json json_of(const likelihood::LikelihoodReport& report) {
  nlohmann::ordered_json j;
  j["training_beams"] = report.training_beams;
  j["held_out_beams"] = report.held_out_beams;
  j["stray_hits"] = report.stray_hits;
  for (const likelihood::LikelihoodStep& s : report.steps) {
    nlohmann::ordered_json step = {{"name", s.name}, {"elements", s.elements}};
    if (s.training_nll) step["training_nll"] = *s.training_nll;
    step["held_out_nll"] = s.held_out_nll;
    step["accepted"] = s.accepted;
    j["steps"].push_back(std::move(step));
  }
  return j;
}

}  // namespace underbrush::fit
