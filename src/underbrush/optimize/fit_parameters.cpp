#include "underbrush/optimize/fit_parameters.hpp"

namespace underbrush::optimize {

std::vector<FitParameter> fit_parameters(const fit::FitOptions& options) {
  std::vector<FitParameter> out;
  for (const auto& [parameter, usually_tuned] : fit::parameters_of(options)) {
    if (!parameter->tuning) continue;
    const fit::TuningRange& range = *parameter->tuning;
    out.push_back({{std::string(parameter->name), range.low, range.high, range.scale},
                   usually_tuned,
                   parameter});
  }
  return out;
}

std::vector<FitParameter> chosen_fit_parameters(const fit::FitOptions& options,
                                                std::span<const std::string> names) {
  const std::vector<FitParameter> all = fit_parameters(options);
  std::vector<FitParameter> out;
  for (const size_t k : chosen(std::vector<Parameter>(all.begin(), all.end()), names)) {
    if (all[k].usual || !names.empty()) out.push_back(all[k]);
  }
  return out;
}

}  // namespace underbrush::optimize
