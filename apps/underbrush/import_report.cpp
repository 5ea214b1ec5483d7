#include "import_report.hpp"

#include <fmt/format.h>

#include "stages.hpp"

namespace underbrush::app {
namespace {

Json json_of(const std::optional<io::ScanClock>& clock) {
  if (!clock) return nullptr;
  return {{"step_s", clock->step_s},
          {"period_s", clock->period_s},
          {"residual_rms_s", clock->residual_rms_s},
          {"scans_fitted", clock->fitted},
          {"scans_kept", clock->kept},
          {"poses_follow", clock->poses_follow}};
}

std::string text_of(const io::ScanClock& clock) {
  std::string text = fmt::format(
      "  clock            times rounded to {:g} ms; period {:.1f} ms, residual {:.1f} ms RMS; "
      "poses "
      "{}\n",
      1e3 * clock.step_s, 1e3 * clock.period_s, 1e3 * clock.residual_rms_s,
      clock.poses_follow ? "follow it" : "keep their times");
  if (clock.kept > 0) {
    text += fmt::format("  note: no steady clock explains the times of {} scans: left as given\n",
                        clock.kept);
  }
  return text;
}

}  // namespace

Json json_of(const pipeline::ImportReport& r) {
  Json j;
  j["format"] = r.format;
  j["scans"] = r.scans;
  j["beams"] = r.beams;
  j["hits"] = r.beam.hits;
  j["misses"] = r.beam.misses_recorded + r.beam.misses_inferred;
  j["misses_recorded"] = r.beam.misses_recorded;
  j["misses_inferred"] = r.beam.misses_inferred;
  j["later_returns"] = r.later_returns;
  j["unknown"] = r.beam.unknown;
  j["scans_ringed_by_elevation"] = r.beam.scans_ringed_by_elevation;
  j["skipped"] = r.skipped;
  j["clock"] = json_of(r.clock);
  j["notes"] = r.notes;
  j["warnings"] = r.warnings;
  return j;
}

std::string text_of(const pipeline::ImportReport& r, const std::string& output) {
  std::string text = fmt::format(
      "{} ({}): {} scans, {} beams\n"
      "  hits             {}\n"
      "  misses recorded  {}\n"
      "  misses inferred  {}\n"
      "  unknown          {}  (beams that tell nothing: left out)\n",
      output, r.format, r.scans, r.beams, r.beam.hits, r.beam.misses_recorded,
      r.beam.misses_inferred, r.beam.unknown);
  if (r.later_returns > 0) {
    text += fmt::format(
        "  later returns    {}  (of the same pulses; fit reads the first ones, or "
        "all with --echoes all)\n",
        r.later_returns);
  }
  for (const auto& [reason, n] : r.skipped)
    text += fmt::format("  skipped          {}  ({})\n", n, reason);
  if (r.beam.scans_ringed_by_elevation > 0) {
    text += fmt::format("  note: rings of {} scans told by elevation\n",
                        r.beam.scans_ringed_by_elevation);
  }
  if (r.clock) text += text_of(*r.clock);
  for (const std::string& note : r.notes) text += "  note: " + note + "\n";
  return text + text_of_warnings(r.warnings);
}

}  // namespace underbrush::app
