#include "report/waveform_outputs.hpp"

#include <fmt/format.h>

#include <fstream>

#include "report/sensor_plots.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/export.hpp"

namespace underbrush::report {
namespace {

void write_csv(const std::string& file, const std::vector<simulate::BeamWaveform>& waveforms) {
  io::write_atomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary);
    out << io::kWaveformColumns << "\n";
    for (const simulate::BeamWaveform& w : waveforms) {
      for (const auto& [range, signal] : w.signal) {
        out << fmt::format("{},{},{},{:.9f},{:.4f},{:.4f}\n", w.beam, w.scan, w.ring, w.time_s,
                           range, signal);
      }
    }
    if (!out.flush()) throw IoError(file + ": cannot write");
  });
}

}  // namespace

std::span<const Option<SimulateFiles>> simulate_files() {
  using O = SimulateFiles;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"waveforms", "Instrument", "",
     "Write digitised waveforms: some beams as a table (.csv) or a plot (.svg), or all beams as "
     ".waves; may be repeated",
     [](O& o) -> auto& { return o.waveforms; }, -kNoLimit, kNoLimit, {}, "FILE"},
    {"profile", "Drivers", "", "Write a folder with a PCD file for each scan, in this driver's PointCloud2 layout",
     [](O& o) -> auto& { return o.profile; }, -kNoLimit, kNoLimit, {"velodyne", "ouster", "autoware"}},
  };
// clang-format on
return kOptions;
}

bool is_waveform_file(const std::string& file) { return file.ends_with(".waves"); }

WaveformOutputs::WaveformOutputs(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    require(file.ends_with(".csv") || file.ends_with(".svg") || is_waveform_file(file),
            "simulate: --waveforms writes .csv, .svg and .waves files");
    io::check_output(file);
    if (is_waveform_file(file)) {
      binary_.push_back(std::make_unique<pipeline::WaveformFile>(file));
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
    size_ += taken.size();
    for (const auto& file : binary_) file->append(taken);
    for (simulate::BeamWaveform& w : taken) {
      if (kept_.size() < most_) kept_.push_back(std::move(w));
    }
  };
}

void WaveformOutputs::write(const sensor::Sensor& sensor) {
  for (const std::string& file : pictures_) {
    file.ends_with(".csv") ? write_csv(file, kept_) : plot_waveforms(file, sensor, kept_);
  }
  for (const auto& file : binary_) file->close();
  binary_.clear();
}

}  // namespace underbrush::report
