#include "waveform_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "cli/outputs.hpp"
#include "report/svg_plot.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::app {
namespace {

constexpr size_t kMostPlotted = 12;

void write_csv(const std::string& file, const std::vector<simulate::BeamWaveform>& waveforms) {
  io::write_atomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << kWaveformColumns << "\n";
    for (const simulate::BeamWaveform& w : waveforms) {
      for (const auto& [range, signal] : w.signal) {
        out << fmt::format("{},{},{},{:.9f},{:.4f},{:.4f}\n", w.beam, w.scan, w.ring, w.time_s,
                           range, signal);
      }
    }
    if (!out.flush()) throw IoError(file + ": cannot write");
  });
}

/// Draws one waveform above the other, each scaled to its own peak (but at least twice the
/// threshold).
void plot(const std::string& file, const sensor::Sensor& s,
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
  report::SvgPlot out(fmt::format("{}: {} waveforms", s.title, shown.size()), "range (m)",
                      "signal, each to its own scale");
  // Labels stand to the left of all signals.
  const double label_m = 0.1 * (to - from) + 0.5;
  out.x_axis(from - label_m, to + 0.5);
  out.y_axis(-0.2, std::max<double>(1, double(shown.size())));
  for (size_t k = 0; k < shown.size(); ++k) {
    const double base = double(shown.size() - 1 - k);
    double top = 2 * s.signal.threshold_snr, before = NAN;
    for (const auto& [range, signal] : shown[k]->signal) top = std::max(top, signal);
    report::SvgPlot::Points points;
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

}  // namespace

bool is_waveform_file(const std::string& file) { return file.ends_with(".waves"); }

WaveformOutputs::WaveformOutputs(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    require(file.ends_with(".csv") || file.ends_with(".svg") || is_waveform_file(file),
            "simulate: --waveforms writes .csv, .svg and .waves files");
    io::check_output(file);
    if (is_waveform_file(file)) {
      binary_.push_back(std::make_unique<WaveformFile>(file));
    } else {
      pictures_.push_back(file);
    }
  }
}

void WaveformOutputs::receive_from(pipeline::SimulateOptions& options) {
  if (binary_.empty() && pictures_.empty()) return;
  most_ = options.waveform.count;
  options.all_waveforms = !binary_.empty();
  options.on_waveforms = [this](std::vector<simulate::BeamWaveform> taken) {
    for (const auto& file : binary_) file->append(taken);
    for (simulate::BeamWaveform& w : taken) {
      if (kept_.size() < most_) kept_.push_back(std::move(w));
    }
  };
}

void WaveformOutputs::write(const sensor::Sensor& sensor) {
  for (const std::string& file : pictures_) {
    file.ends_with(".csv") ? write_csv(file, kept_) : plot(file, sensor, kept_);
  }
  for (const auto& file : binary_) file->close();
  binary_.clear();
}

}  // namespace underbrush::app
