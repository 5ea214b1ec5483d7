/// \file
/// What the receiver gives for one ideal point target: the emitted pulse through the receiver.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sensor/signal.hpp"

namespace underbrush {
/// From the light that sub-rays bring back to the echoes that a sensor reports.
namespace radiometry {

/// Speed of light in vacuum, m/s.
inline constexpr double kSpeedOfLight = 299792458;

using sensor::Pulse;

/// Times of the transmitter and the receiver.
struct ResponseOptions {
  Pulse pulse = Pulse::kGaussian;
  double pulse_fwhm_s = 5e-9;
  double receiver_fwhm_s = 0;  ///< Of the receiver's Gaussian impulse response; 0 = ideal.
  double sample_s = 1e-9;      ///< Between samples of the analog–digital converter.
};

/// The response h of transmitter and receiver to a point target, over range: the pulse convolved
/// with the receiver's impulse response, its peak 1 at distance 0 (a sensor is calibrated to that),
/// zero where it falls below 10⁻⁴. Sampled at cells of c·sample_s/2 for `kPhases` places of the
/// target within a cell.
class Response {
 public:
  static constexpr int kPhases = 256;

  /// Throws `std::invalid_argument` unless the times are positive, finite and the pulse is at most
  /// 500 samples long.
  explicit Response(const ResponseOptions& options);

  /// Range between samples (m).
  double cell_m() const { return cell_m_; }
  /// h at a distance (m) behind the target, by linear interpolation of the fine table.
  double at(double distance_m) const;
  /// ∫ h (m).
  double area_m() const { return area_m_; }
  /// Samples per target, a multiple of 8; sample k lies k − `before()` cells behind the cell that
  /// holds the target.
  int taps() const { return taps_; }
  int before() const { return before_; }
  /// h at the taps for a target (`phase` + ½)/kPhases of a cell behind its cell's start.
  const float* row(int phase) const { return rows_.data() + size_t(phase) * size_t(taps_); }

 private:
  double cell_m_, first_m_ = 0, step_m_ = 0, area_m_ = 0;
  std::vector<double> fine_;  ///< h at first + k · step.
  std::vector<float> rows_;
  int taps_ = 0, before_ = 0;
};

}  // namespace radiometry
}  // namespace underbrush
