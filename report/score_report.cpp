#include "report/score_report.hpp"

#include "report/report.hpp"

namespace underbrush::report {

std::filesystem::path write_score_report(
    const std::filesystem::path& folder, const Json& results, const std::filesystem::path& real,
    const std::vector<std::pair<std::string, std::filesystem::path>>& simulated) {
  Comparison comparison{"", "", results, real, {}};
  for (const auto& [name, log] : simulated) comparison.simulated.push_back({name, log});
  return write_report(
      folder, {"Simulated against real: " + real.filename().string(), "", {std::move(comparison)}});
}

}  // namespace underbrush::report
