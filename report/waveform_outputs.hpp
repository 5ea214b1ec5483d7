/// \file
/// The files of `simulate --waveforms`: tables and plots of some beams, and binary files of all.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "underbrush/pipeline/simulate_options.hpp"
#include "underbrush/pipeline/waveform_file.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::report {

/// Files that `simulate` writes besides a log, and the layout of the log's.
struct SimulateFiles {
  std::vector<std::string> waveforms;
  std::string profile;  ///< The name of an `io::DriverLayout`; "" = none.
};
/// The table of these options.
std::span<const Option<SimulateFiles>> simulate_files();

/// Whether a file for waveforms is binary, and so has those of all beams.
bool is_waveform_file(const std::string& file);

/// The outputs of waveforms of one simulation.
class WaveformOutputs {
 public:
  /// Throws `std::invalid_argument` for a suffix that is none of .csv, .svg and .waves, and
  /// `IoError` for a file that cannot be written.
  explicit WaveformOutputs(const std::vector<std::string>& files);
  WaveformOutputs(const WaveformOutputs&) = delete;
  WaveformOutputs& operator=(const WaveformOutputs&) = delete;

  /// Lets the simulation of these options give its waveforms to this, which must outlive it.
  void receive_from(pipeline::SimulateOptions& options);
  /// Returns the number of waveforms.
  size_t size() const { return size_; }
  /// Writes all files. `sensor` gives the title of a plot.
  void write(const sensor::Sensor& sensor);

 private:
  std::vector<std::string> pictures_;  ///< Files of tables and plots.
  std::vector<std::unique_ptr<pipeline::WaveformFile>> binary_;
  std::vector<simulate::BeamWaveform> kept_;  ///< Waveforms for tables and plots.
  size_t most_ = 0, size_ = 0;
};

}  // namespace underbrush::report
