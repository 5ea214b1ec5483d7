#include "underbrush/pipeline/sensor_echo.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/radiometry/link_budget.hpp"
#include "underbrush/radiometry/materials.hpp"

namespace underbrush::pipeline {
namespace {

/// A target given as RANGE[:MATERIAL[:SHARE]].
struct Target {
  float range_m = 0, share = 0, factor = 0;
};

std::vector<Target> targets_of(const sensor::Sensor& s, const std::vector<std::string>& words) {
  const radiometry::Materials materials = radiometry::load_materials();
  std::vector<Target> targets;
  for (const std::string& word : words) {
    const size_t first = word.find(':'),
                 second = word.find(':', std::min(first, word.size() - 1) + 1);
    const auto range = io::number_of(word.substr(0, first));
    const bool shared = first != std::string::npos && second != std::string::npos;
    const auto share = shared ? io::number_of(word.substr(second + 1)) : 1.0 / double(words.size());
    require(
        range && share && *range > 0 && *share > 0 && *share <= 1,
        "sensors echo: a target is RANGE, RANGE:MATERIAL or RANGE:MATERIAL:SHARE, shares 0 to 1");
    const std::string name = first == std::string::npos
                                 ? "grey_target"
                                 : word.substr(first + 1, shared ? second - first - 1 : second);
    const radiometry::Material& m = materials.named(name);
    targets.push_back(
        {float(*range), float(*share),
         float(m.reflectance_at(s.wavelength_m) * radiometry::backscatter(m.surface, 1))});
  }
  return targets;
}

}  // namespace

SensorEcho echo_of_targets(const sensor::Sensor& sensor, const std::vector<std::string>& targets,
                           double visibility_m, double rain_mm_per_h, uint64_t seed) {
  double air = radiometry::rain_extinction_per_m(rain_mm_per_h);
  if (visibility_m > 0) air += radiometry::fog_extinction_per_m(visibility_m, sensor.wavelength_m);
  const radiometry::Receiver receiver(radiometry::receiver_options(sensor, air));
  std::vector<float> range, weight, factor;
  for (const Target& t : targets_of(sensor, targets)) {
    range.push_back(t.range_m);
    weight.push_back(t.share);
    factor.push_back(t.factor);
  }
  SensorEcho out;
  out.extinction_per_m = air;
  out.signal.resize(range.size());
  radiometry::Waveform waveform = receiver.scratch();
  out.echoes = receiver.receive(range, weight, factor, out.signal, beam_key(seed, 0, 0), waveform,
                                radiometry::Receiver::Way::kByWaveform);
  out.waveform = radiometry::table_of(waveform);
  out.cell_m = waveform.cell_m();
  return out;
}

}  // namespace underbrush::pipeline
