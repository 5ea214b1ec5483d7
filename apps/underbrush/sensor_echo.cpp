#include "sensor_echo.hpp"

#include <fmt/format.h>

#include "report/sensor_plots.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/pipeline/sensor_echo.hpp"

namespace underbrush::app {
namespace {

void write_csv(const pipeline::SensorEcho& echo, const std::string& file) {
  std::string text = "range_m,signal\n";
  for (const auto& [range, signal] : echo.waveform) {
    text += fmt::format("{:.4f},{:.4f}\n", range, signal);
  }
  io::write_atomically(file, text);
}

}  // namespace

void echo_of_sensor(const Verb& verb, const SensorsArguments& a) {
  const sensor::Sensor s = sensor::load(a.name);
  const pipeline::SensorEcho echo =
      pipeline::echo_of_targets(s, a.targets, a.visibility_m, a.rain_mm_per_h, verb.seed);
  if (!a.csv.empty()) write_csv(echo, a.csv);
  if (!a.plot.empty()) report::plot_echoes(s, echo, a.plot);
  Json j;
  j["sensor"] = s.name;
  j["extinction_per_m"] = echo.extinction_per_m;
  j["signals"] = echo.signal;
  j["echoes"] = Json::array();
  std::string table = fmt::format("{}: {} of {} targets' light, {} echoes\n", s.name, s.title,
                                  a.targets.size(), echo.echoes.count);
  for (const radiometry::Echo& e : echo.echoes) {
    j["echoes"].push_back({{"range_m", e.range_m},
                           {"intensity", e.intensity},
                           {"signal_to_noise", e.peak},
                           {"pulse_width_m", e.width_m}});
    table += fmt::format("  {:9.3f} m  intensity {:g}  signal/noise {:.1f}  pulse width {:.3f} m\n",
                         e.range_m, e.intensity, e.peak, e.width_m);
  }
  verb.report(j, table);
}

}  // namespace underbrush::app
