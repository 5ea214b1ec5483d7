#include "underbrush/jobs/plan_status.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"

namespace underbrush::jobs {

PlanStatus status_of(const std::filesystem::path& folder, const Plan& plan, bool outputs) {
  PlanStatus out;
  for (size_t k = 0; k < plan.tasks.size(); ++k) {
    try {
      if (const auto record = checked_record(folder, plan, k, outputs)) {
        out.done.push_back(k);
        out.seconds += record->seconds;
        out.processor_s += record->processor_s;
        out.output_bytes += record->output_bytes;
        out.peak_memory_bytes = std::max(out.peak_memory_bytes, record->peak_memory_bytes);
      } else if (const auto failure = read_failure(folder, k)) {
        out.failed.push_back(k);
        out.failures[k] = *failure;
      } else {
        out.missing.push_back(k);
      }
    } catch (const FormatError& e) {
      out.wrong[k] = e.what();
    }
  }
  return out;
}

}  // namespace underbrush::jobs
