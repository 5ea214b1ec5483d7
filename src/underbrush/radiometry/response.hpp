/// \file
/// This file has the response of transmitter and receiver to one ideal point target.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sensor/signal.hpp"

namespace underbrush {
/// Radiometry: it turns the light that sub-rays bring back into the echoes that a sensor reports.
namespace radiometry {

/// Speed of light in vacuum, m/s.
inline constexpr double kSpeedOfLight = 299792458;

using sensor::Pulse;

/// The times of the transmitter and the receiver.
struct ResponseOptions {
  Pulse pulse = Pulse::kGaussian;
  double pulse_fwhm_s = 5e-9;
  double receiver_fwhm_s = 0;  ///< Width of the receiver's Gaussian impulse response; 0 = ideal.
  double sample_s = 1e-9;      ///< Time between samples of the analog–digital converter.
};

/// The response h of transmitter and receiver to a point target, over range. It is the pulse
/// convolved with the receiver's impulse response. Its peak is 1 and lies at distance 0, because
/// sensors are calibrated to it, and it is zero where it falls below 10⁻⁴. It is sampled at cells
/// of c·sample_s/2 for `kPhases` places of the target within a cell.
class Response {
 public:
  static constexpr int kPhases = 256;

  /// Throws `std::invalid_argument` unless the times are positive and finite and the pulse is at
  /// most 500 samples long.
  explicit Response(const ResponseOptions& options);

  /// The range between samples, m.
  double cell_m() const { return cell_m_; }
  /// h at a distance (m) behind the target, by linear interpolation of the fine table.
  double at(double distance_m) const;
  /// ∫ h dr, m.
  double area_m() const { return area_m_; }
  /// The number of samples that a target reaches, a multiple of 8. Sample k lies k − `before()`
  /// cells behind the cell that holds the target.
  int taps() const { return taps_; }
  int before() const { return before_; }
  /// h at the taps for a target that lies (`phase` + ½)/kPhases of a cell behind its cell's start.
  const float* row(int phase) const { return rows_.data() + size_t(phase) * size_t(taps_); }
  /// The filter that the receiver is for noise, an odd number of taps, whose squares sum to 1. It
  /// is the receiver's impulse response; an ideal receiver is taken to be as fast as the pulse.
  std::span<const float> noise_filter() const { return noise_filter_; }

 private:
  double cell_m_, first_m_ = 0, step_m_ = 0, area_m_ = 0;
  std::vector<double> fine_;  ///< h at first + k · step.
  std::vector<float> rows_, noise_filter_;
  int taps_ = 0, before_ = 0;
};

}  // namespace radiometry
}  // namespace underbrush
