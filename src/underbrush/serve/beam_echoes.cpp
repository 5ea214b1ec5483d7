#include "underbrush/serve/beam_echoes.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/serve/json_reply.inl"

namespace underbrush::serve {
namespace {

// Names lead to the catalogue alone, never to a file.
sensor::Sensor sensor_named(const std::string& name) {
  const auto entries = sensor::catalogue();
  const bool known = std::any_of(entries.begin(), entries.end(),
                                 [&](const sensor::CatalogueEntry& e) { return e.name == name; });
  require(known, "the catalogue has no such sensor");
  return sensor::load(name);
}

sensor::Sensor sensor_of(const BeamLog& log, const std::string& name) {
  if (!name.empty()) return sensor_named(name);
  require(!log.info.sensor.empty(), "the log does not name its sensor: choose one");
  if (log.info.sensor_file.empty()) return sensor_named(log.info.sensor);
  return sensor::sensor_of_log("log", log.info);
}

Json echoes_of(const BeamLog& rows) {
  Json out = Json::array();
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!rows.is_hit(i)) continue;
    Json echo{{"range_m", rows.range_m[i]}, {"intensity", rows.intensity[i]}};
    for (const auto& [name, column] : rows.extra) {
      std::visit([&, key = name](const auto& c) { echo[key] = c[i]; }, column);
    }
    out.push_back(std::move(echo));
  }
  return out;
}

}  // namespace

std::string beam_echoes(const LoggedBeam& beam, const WorldData& world, const std::string& name,
                        uint64_t seed) {
  BeamLog rows = beam.rows;
  keep_first_echoes(rows);
  rows.extra.clear();
  Json j{{"sensor", ""}, {"seed", seed}};
  j["range_m"] = Json::array();
  j["signal"] = Json::array();
  pipeline::SimulateOptions options;
  options.seed = seed;
  options.instrument.super_sample = "sensor";
  options.all_waveforms = true;
  options.on_waveforms = [&](const std::vector<simulate::BeamWaveform>& waveforms) {
    for (const simulate::BeamWaveform& w : waveforms) {
      for (const auto& [range, signal] : w.signal) {
        j["range_m"].push_back(float(range));
        j["signal"].push_back(float(signal));
      }
    }
  };
  pipeline::Simulation simulation(world.traced(), options,
                                  [&](const char*) { return sensor_of(rows, name); });
  j["sensor"] = simulation.sensor().name;
  j["sub_rays"] = simulation.sub_rays();
  j["threshold"] = simulation.sensor().signal.threshold_snr;
  simulation.answer(beam.number, rows);
  j["echoes"] = echoes_of(rows);
  return text_of(j);
}

}  // namespace underbrush::serve
