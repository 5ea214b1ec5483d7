#include "sensor_echo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/svg_plot.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/radiometry/link_budget.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::app {
namespace {

using sensor::Sensor;

/// A target given as RANGE[:MATERIAL[:SHARE]].
struct Target {
  float range_m = 0, share = 0, factor = 0;
};

std::vector<Target> targets_of(const SensorsArguments& a, const Sensor& s) {
  const radiometry::Materials materials = radiometry::load_materials();
  std::vector<Target> targets;
  for (const std::string& word : a.targets) {
    const size_t first = word.find(':'),
                 second = word.find(':', std::min(first, word.size() - 1) + 1);
    const auto range = io::number_of(word.substr(0, first));
    const bool shared = first != std::string::npos && second != std::string::npos;
    const auto share =
        shared ? io::number_of(word.substr(second + 1)) : 1.0 / double(a.targets.size());
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

void write_csv(const radiometry::Waveform& waveform, const std::string& file) {
  std::string text = "range_m,signal\n";
  for (const auto& [range, signal] : radiometry::table_of(waveform)) {
    text += fmt::format("{:.4f},{:.4f}\n", range, signal);
  }
  io::write_atomically(file, text);
}

/// Returns a height for the label of each echo, above its peak and above the labels that it would
/// cover.
std::vector<double> label_heights(const std::vector<radiometry::Echo>& echoes, double width_m,
                                  double top) {
  const double wide = 0.08 * width_m, high = 0.045 * top;  // of a label, with its margin
  std::vector<double> heights;
  for (size_t k = 0; k < echoes.size(); ++k) {
    double height = 1.03 * double(echoes[k].peak);
    for (bool moved = true; moved;) {
      moved = false;
      for (size_t j = 0; j < k; ++j) {
        const bool covers =
            std::abs(double(echoes[k].range_m) - double(echoes[j].range_m)) < wide &&
            std::abs(height - heights[j]) < high;
        if (!covers) continue;
        height = heights[j] + 1.01 * high;
        moved = true;
      }
    }
    heights.push_back(height);
  }
  return heights;
}

void plot_waveform(const Sensor& s, const radiometry::Waveform& waveform,
                   const radiometry::Echoes& echoes, const std::string& file) {
  report::SvgPlot::Points points;
  double top = 2 * s.signal.threshold_snr;
  for (const auto& [range, signal] : radiometry::table_of(waveform)) {
    if (!points.empty() && range - points.back().first > 1.5 * waveform.cell_m()) {
      points.emplace_back(range, NAN);
    }
    points.emplace_back(range, signal);
    top = std::max(top, signal);
  }
  report::SvgPlot plot(s.title + ": received signal", "range (m)", "signal / noise");
  const double from = points.empty() ? 0 : points.front().first - 1;
  const double to = points.empty() ? s.max_range_m : points.back().first + 1;
  const std::vector<radiometry::Echo> shown(echoes.begin(), echoes.end());
  const std::vector<double> labels = label_heights(shown, to - from, top);
  double highest = 1.1 * top;
  for (const double height : labels) highest = std::max(highest, height + 0.07 * top);
  plot.x_axis(from, to);
  plot.y_axis(-0.1 * top, highest);
  plot.line(points, "#1f6f4a");
  plot.line({{from, s.signal.threshold_snr}, {to, s.signal.threshold_snr}}, "#b03030", true);
  for (size_t k = 0; k < shown.size(); ++k) {
    const radiometry::Echo& e = shown[k];
    plot.line({{e.range_m, 0}, {e.range_m, e.peak}}, "#2050a0", true);
    plot.text(e.range_m, labels[k], fmt::format("{:.3f} m", e.range_m));
  }
  plot.write(file);
}

}  // namespace

void echo_of_sensor(const Verb& verb, const SensorsArguments& a) {
  const Sensor s = sensor::load(a.name);
  double air = radiometry::rain_extinction_per_m(a.rain_mm_per_h);
  if (a.visibility_m > 0) air += radiometry::fog_extinction_per_m(a.visibility_m, s.wavelength_m);
  const radiometry::Receiver receiver(radiometry::receiver_options(s, air));
  radiometry::Waveform waveform = receiver.scratch();
  std::vector<float> range, weight, factor;
  for (const Target& t : targets_of(a, s)) {
    range.push_back(t.range_m);
    weight.push_back(t.share);
    factor.push_back(t.factor);
  }
  std::vector<float> signal(range.size());
  const radiometry::Echoes echoes =
      receiver.receive(range, weight, factor, signal, beam_key(verb.seed, 0, 0), waveform,
                       radiometry::Receiver::Way::kByWaveform);
  if (!a.csv.empty()) write_csv(waveform, a.csv);
  if (!a.plot.empty()) plot_waveform(s, waveform, echoes, a.plot);
  Json j;
  j["sensor"] = s.name;
  j["extinction_per_m"] = air;
  j["signals"] = signal;
  j["echoes"] = Json::array();
  std::string table = fmt::format("{}: {} of {} targets' light, {} echoes\n", s.name, s.title,
                                  range.size(), echoes.count);
  for (const radiometry::Echo& e : echoes) {
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
