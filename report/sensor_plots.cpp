#include "report/sensor_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "underbrush/sensor/pattern.hpp"

namespace underbrush::report {
namespace {

using sensor::Sensor;

constexpr size_t kMostDots = 4000, kMostPlotted = 12;

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

}  // namespace

SvgPlot::Points one_scan(const Sensor& s, size_t most) {
  const Trajectory still({{0, Pose{}}});
  sensor::PatternSource source(s, still, 0, 1 / s.rate_hz, most);
  BeamLog log;
  source.next(log);
  SvgPlot::Points points;
  for (const Vec3f& d : log.direction) {
    const double z = std::clamp(double(d.z()), -1.0, 1.0);
    points.emplace_back(std::atan2(double(d.y()), double(d.x())) / kDegree, std::asin(z) / kDegree);
  }
  return points;
}

void plot_pattern(const Sensor& s, SvgPlot::Points scan, const std::string& file) {
  double half = 180;
  const auto inside = [&](const auto& p) { return std::abs(p.first) <= half; };
  while (half > 2 && size_t(std::count_if(scan.begin(), scan.end(), inside)) > kMostDots)
    half *= 0.8;
  std::erase_if(scan, [&](const auto& p) { return !inside(p); });
  double west = 1, low = 1, high = -1;
  for (const auto& [azimuth, elevation] : scan) {
    west = std::max(west, std::abs(azimuth));
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  SvgPlot plot(fmt::format("{}: one scan{}", s.title,
                           half < 180 ? fmt::format(", ±{:.0f}° ahead", half) : ""),
               "azimuth (degrees, left is positive)", "elevation (degrees)");
  plot.x_axis(1.02 * west, -1.02 * west);
  plot.y_axis(low - 0.05 * (high - low) - 0.1, high + 0.05 * (high - low) + 0.1);
  plot.dots(scan, "#1f6f4a", 2);
  plot.write(file);
}

void plot_echoes(const Sensor& s, const pipeline::SensorEcho& echo, const std::string& file) {
  SvgPlot::Points points;
  double top = 2 * s.signal.threshold_snr;
  for (const auto& [range, signal] : echo.waveform) {
    if (!points.empty() && range - points.back().first > 1.5 * echo.cell_m) {
      points.emplace_back(range, NAN);
    }
    points.emplace_back(range, signal);
    top = std::max(top, signal);
  }
  SvgPlot plot(s.title + ": received signal", "range (m)", "signal / noise");
  const double from = points.empty() ? 0 : points.front().first - 1;
  const double to = points.empty() ? s.max_range_m : points.back().first + 1;
  const std::vector<radiometry::Echo> shown(echo.echoes.begin(), echo.echoes.end());
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

void plot_waveforms(const std::string& file, const sensor::Sensor& s,
                    const std::vector<simulate::BeamWaveform>& waveforms) {
  std::vector<const simulate::BeamWaveform*> shown;
  for (const auto& w : waveforms) {
    if (!w.signal.empty() && shown.size() < kMostPlotted) shown.push_back(&w);
  }
  double from = INFINITY, to = -INFINITY;
  for (const auto* w : shown) {
    from = std::min(from, w->signal.front().first);
    to = std::max(to, w->signal.back().first);
  }
  if (shown.empty()) from = 0, to = s.max_range_m;
  SvgPlot out(fmt::format("{}: {} waveforms", s.title, shown.size()), "range (m)",
              "signal, each to its own scale");
  // Labels stand to the left of all signals.
  const double label_m = 0.1 * (to - from) + 0.5;
  out.x_axis(from - label_m, to + 0.5);
  out.y_axis(-0.2, std::max<double>(1, double(shown.size())));
  for (size_t k = 0; k < shown.size(); ++k) {
    const double base = double(shown.size() - 1 - k);
    double top = 2 * s.signal.threshold_snr, before = NAN;
    for (const auto& [range, signal] : shown[k]->signal) top = std::max(top, signal);
    SvgPlot::Points points;
    for (const auto& [range, signal] : shown[k]->signal) {
      if (range - before > 2) points.emplace_back(range, NAN);
      points.emplace_back(range, base + 0.85 * signal / top);
      before = range;
    }
    out.line(points, "#1f6f4a");
    const double level = base + 0.85 * s.signal.threshold_snr / top;
    out.line({{from, level}, {to, level}}, "#b03030", true);
    for (const double r : shown[k]->echo_m)
      out.line({{r, base}, {r, base + 0.85}}, "#2050a0", true);
    out.text(from - 0.95 * label_m, base + 0.3, fmt::format("beam {}", shown[k]->beam));
  }
  out.write(file);
}

}  // namespace underbrush::report
