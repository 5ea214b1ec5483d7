#include "report/log_text.hpp"

#include <fmt/format.h>

#include "underbrush/io/json_text.inl"

namespace underbrush::report {

using pipeline::LogContents;

Json json_of_log(const io::Input& input, const LogContents& c) {
  const LogInfo& info = input.beams->info();
  Json j;
  j["kind"] = "log";
  j["format"] = input.format;
  j["beams"] = c.beams;
  j["hits"] = c.hits;
  j["echoes"] = c.echoes;
  j["misses"] = c.recorded + c.inferred;
  j["misses_recorded"] = c.recorded;
  j["misses_inferred"] = c.inferred;
  j["has_misses"] = info.has_misses;
  if (c.hits) {
    j["bounds_m"] = {{"min", {c.low.x(), c.low.y(), c.low.z()}},
                     {"max", {c.high.x(), c.high.y(), c.high.z()}}};
  }
  j["time_s"] = {{"first", c.first_s}, {"last", c.last_s}};
  j["scans"] = c.scans.size();
  j["rings"] = c.rings.size();
  j["poses"] = info.scans.size();
  Json& range = j["range_m"];
  for (const int percent : {1, 10, 50, 90, 99}) {
    if (c.hits) range["p" + std::to_string(percent)] = c.range_percentile(percent / 100.0);
  }
  if (c.hits) j["intensity"] = {{"min", c.low_intensity}, {"max", c.high_intensity}};
  j["min_range_m"] = info.min_range_m;
  j["max_range_m"] = info.max_range_m;
  j["sensor"] = info.sensor;
  j["sensor_guess"] = pipeline::sensor_guess(info, c.rings.size());
  j["deskewed"] = info.deskewed;
  j["extra_columns"] = c.extra;
  j["skipped"] = input.skipped();
  j["provenance"] = input.provenance.empty() ? Json(nullptr) : io::json_of_text(input.provenance);
  return j;
}

std::string table_of_log(const std::string& file, const LogInfo& info, const LogContents& c,
                         const Json& j) {
  const double length = c.last_s - c.first_s;
  std::string text =
      fmt::format("{}: {} beams, {} hits, {} misses ({} recorded, {} inferred)\n", file, c.beams,
                  c.hits, c.recorded + c.inferred, c.recorded, c.inferred);
  if (c.echoes > c.hits) text += fmt::format("  echoes     {}\n", c.echoes);
  if (c.hits) {
    text +=
        fmt::format("  bounds     x {:.2f} to {:.2f}  y {:.2f} to {:.2f}  z {:.2f} to {:.2f} m\n",
                    c.low.x(), c.high.x(), c.low.y(), c.high.y(), c.low.z(), c.high.z());
    text += fmt::format(
        "  ranges     1 % {:.2f}  10 % {:.2f}  50 % {:.2f}  90 % {:.2f}  99 % {:.2f} m\n",
        c.range_percentile(0.01), c.range_percentile(0.1), c.range_percentile(0.5),
        c.range_percentile(0.9), c.range_percentile(0.99));
    text += fmt::format("  intensity  {:g} to {:g}\n", c.low_intensity, c.high_intensity);
  }
  text += fmt::format("  time       {:.3f} to {:.3f} s ({:.3f} s)\n", c.first_s, c.last_s, length);
  text += fmt::format("  scans      {}, {} with a pose, {} rings, {}\n", c.scans.size(),
                      info.scans.size(), c.rings.size(),
                      info.deskewed ? "every beam at its own origin (de-skewed)"
                                    : "one origin a scan (not de-skewed)");
  text += fmt::format("  limits     {:g} to {:g} m{}\n", info.min_range_m, info.max_range_m,
                      info.has_misses ? "" : "; no misses in this log");
  std::string sensors;
  for (const auto& name : j["sensor_guess"]) {
    sensors += (sensors.empty() ? "" : ", ") + name.get<std::string>();
  }
  text += fmt::format("  sensor     {}{}\n", sensors.empty() ? "unknown" : sensors,
                      info.sensor.empty() && !sensors.empty() ? " (guess by rings)" : "");
  if (!c.extra.empty()) text += fmt::format("  columns    {}\n", fmt::join(c.extra, ", "));
  for (const auto& [reason, n] : j["skipped"].items()) {
    text += fmt::format("  skipped    {} ({})\n", n.get<size_t>(), reason);
  }
  if (j["provenance"].is_object() && j["provenance"].contains("command")) {
    std::string words;
    for (const auto& word : j["provenance"]["command"]) words += " " + word.get<std::string>();
    text += "  made by   " + words + "\n";
  }
  return text;
}

}  // namespace underbrush::report
