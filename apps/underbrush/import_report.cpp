#include "import_report.hpp"

#include <fmt/format.h>

namespace underbrush::app {

constexpr double kFewMisses = 0.03;  // of all recorded

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

std::string nothing_usable(const ImportCounts& c, bool points_in_world) {
  std::string text = "no usable beams in it";
  const char* separator = ": ";
  for (const auto& [reason, n] : c.skipped) {
    text += fmt::format("{}{} {}", separator, n, reason);
    separator = ", ";
  }
  if (c.skipped.count(io::kFarFromSensor) && !points_in_world) {
    text +=
        "; are its coordinates those of the world? Then --poses must say where the sensor stood, "
        "and --points-in-world";
  }
  return text;
}

std::vector<std::string> warnings_of(const ImportCounts& c) {
  const auto lost = c.skipped.find(sensor::kNoGrid);
  if (lost == c.skipped.end()) return {};
  const size_t recorded = c.beam.misses_recorded + lost->second;
  if (double(lost->second) <= kFewMisses * double(recorded)) return {};
  return {
      fmt::format("{} of {} recorded misses are lost ({}): a model fitted to this log takes "
                  "plants for denser than they are",
                  lost->second, recorded, sensor::kNoGrid)};
}

Json json_of(const io::Input& input, const ImportCounts& c,
             const std::vector<std::string>& warnings) {
  Json j;
  j["format"] = input.format;
  j["scans"] = c.scans;
  j["beams"] = c.beams;
  j["hits"] = c.beam.hits;
  j["misses"] = c.beam.misses_recorded + c.beam.misses_inferred;
  j["misses_recorded"] = c.beam.misses_recorded;
  j["misses_inferred"] = c.beam.misses_inferred;
  j["later_returns"] = c.later_returns;
  j["unknown"] = c.beam.unknown;
  j["scans_ringed_by_elevation"] = c.beam.scans_ringed_by_elevation;
  j["skipped"] = c.skipped;
  j["clock"] = json_of(input.clock);
  j["notes"] = input.notes;
  j["warnings"] = warnings;
  return j;
}

std::string table_of(const io::Input& input, const ImportCounts& c, const std::string& output) {
  std::string text = fmt::format(
      "{} ({}): {} scans, {} beams\n"
      "  hits             {}\n"
      "  misses recorded  {}\n"
      "  misses inferred  {}\n"
      "  unknown          {}  (beams that tell nothing: left out)\n",
      output, input.format, c.scans, c.beams, c.beam.hits, c.beam.misses_recorded,
      c.beam.misses_inferred, c.beam.unknown);
  if (c.later_returns > 0) {
    text += fmt::format(
        "  later returns    {}  (of the same pulses; fit reads the first ones, or "
        "all with --echoes all)\n",
        c.later_returns);
  }
  for (const auto& [reason, n] : c.skipped)
    text += fmt::format("  skipped          {}  ({})\n", n, reason);
  if (c.beam.scans_ringed_by_elevation > 0) {
    text += fmt::format("  note: rings of {} scans told by elevation\n",
                        c.beam.scans_ringed_by_elevation);
  }
  if (input.clock) text += text_of(*input.clock);
  for (const std::string& note : input.notes) text += "  note: " + note + "\n";
  return text;
}

}  // namespace underbrush::app
