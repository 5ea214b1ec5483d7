#include "underbrush/serve/beam_echoes.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/sensor/catalogue.hpp"
#include "underbrush/serve/json_reply.inl"
#include "underbrush/simulate/reflection.hpp"

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
                        const InstrumentOf& instrument_of, uint64_t seed) {
  BeamLog rows = beam.rows;
  keep_first_echoes(rows);
  rows.extra.clear();
  const sensor::Sensor sensor = sensor_of(rows, name);
  const simulate::Instrument instrument = instrument_of(sensor, world.scene().models);
  simulate::InstanceKinds kinds = simulate::instance_kinds(world.scene(), world.info());
  const simulate::Reflection reflection(
      simulate::with_own_materials(radiometry::load_materials(), kinds), sensor.wavelength_m,
      kinds);
  simulate::EchoOptions options;
  options.seed = seed;
  options.instance_labels = world.info().labels;
  options.waveforms = {1, SIZE_MAX};
  simulate::EchoMaker maker(world.dynamic(), reflection, instrument, options);
  maker.answer(beam.number, rows);
  Json j{{"sensor", sensor.name},
         {"seed", seed},
         {"sub_rays", instrument.sub_rays.size()},
         {"threshold", sensor.signal.threshold_snr}};
  j["range_m"] = Json::array();
  j["signal"] = Json::array();
  for (const simulate::BeamWaveform& w : maker.waveforms()) {
    for (const auto& [range, signal] : w.signal) {
      j["range_m"].push_back(float(range));
      j["signal"].push_back(float(signal));
    }
  }
  j["echoes"] = echoes_of(rows);
  return text_of(j);
}

}  // namespace underbrush::serve
