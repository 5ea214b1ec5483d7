#include "report/intensity_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace underbrush::report {
namespace {

using metrics::IntensityErrors;
using metrics::IntensityScore;

using ValueOfIntensity = std::function<double(const IntensityScore&)>;

std::string row(const std::string& label, const std::vector<metrics::Score>& scores,
                const ValueOfIntensity& value) {
  std::string line = fmt::format("  {:<24}", label);
  for (const metrics::Score& s : scores) {
    const double x = s.intensity ? value(*s.intensity) : NAN;
    line += std::isfinite(x) ? fmt::format("{:>14.4g}", x) : fmt::format("{:>14}", "n/a");
  }
  return line + "\n";
}

using Bins = std::map<std::string, IntensityErrors>;

std::string rows_of_bins(const char* unit, const std::vector<metrics::Score>& scores,
                         const Bins& first, Bins IntensityScore::*bins) {
  // The text of the map's order would put 10 before 5.
  std::vector<std::string> names;
  for (const auto& [name, errors] : first) names.push_back(name);
  std::sort(names.begin(), names.end(),
            [](const std::string& a, const std::string& b) { return std::stoi(a) < std::stoi(b); });
  std::string text;
  for (const std::string& name : names) {
    text += row(fmt::format("  RMSE, {} {}", name, unit), scores, [&](const IntensityScore& s) {
      const auto found = (s.*bins).find(name);
      return found == (s.*bins).end() ? NAN : found->second.rmse;
    });
  }
  return text;
}

}  // namespace

std::string table_of_intensities(const std::vector<metrics::Score>& scores) {
  const auto has_some = [](const metrics::Score& s) { return s.intensity.has_value(); };
  const auto some = std::find_if(scores.begin(), scores.end(), has_some);
  if (some == scores.end()) {
    return fmt::format("  intensity not scored: {}\n", scores.at(0).no_intensity);
  }
  const IntensityScore& first = *some->intensity;
  std::string text;
  text += row("intensity RMSE", scores, [](const auto& s) { return s.simulated.rmse; });
  text += row("  of one constant", scores, [](const auto& s) { return s.constant.rmse; });
  if (!first.groups.empty()) {
    text += row("  of one a " + first.groups, scores,
                [](const auto& s) { return s.group_constant.rmse; });
  }
  text += rows_of_bins("m", scores, first.per_range, &IntensityScore::per_range);
  text += rows_of_bins("deg", scores, first.per_incidence, &IntensityScore::per_incidence);
  text += row("intensity MAE", scores, [](const auto& s) { return s.simulated.mae; });
  text += row("  of one constant", scores, [](const auto& s) { return s.constant.mae; });
  text +=
      row("intensity correlation", scores, [](const auto& s) { return s.simulated.correlation; });
  text += row("intensity distribution", scores, [](const auto& s) { return s.wasserstein; });
  return text +
         "    (constants are means of the real log; the distribution's row is the Wasserstein "
         "distance)\n";
}

}  // namespace underbrush::report
