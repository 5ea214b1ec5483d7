/// \file
/// This file draws the echo of a return that stands alone, without its waveform.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "underbrush/radiometry/detector.hpp"

namespace underbrush::radiometry {

/// Returns of one beam that lie so close together that they count as one.
struct LoneReturn {
  float range_m = 0;  ///< The mean, weighted by the signals.
  float signal = 0;   ///< The sum; 0 where there is no return, or more than one.
};

/// Joins the returns of a beam in [0, `max_range_m`] whose signal is positive, if all of them lie
/// within `apart_m`.
LoneReturn lone_return(std::span<const float> range_m, std::span<const float> signal,
                       float max_range_m, float apart_m);

/// The echoes of a point target under noise, by the ratio of its signal to the noise. Their means
/// and covariances (of range, peak, width and energy) are measured once on waveforms, at ratios
/// between which they are interpolated, and echoes are drawn from normal distributions of these
/// moments. Ratios are covered from the least one at which each measured waveform has exactly one
/// echo, up to the greatest.
class LoneEcho {
 public:
  /// A function that finds the echoes of a point target from its waveform.
  using Detect = std::function<Echoes(float range_m, float signal, uint64_t key)>;

  /// Measures signals of `least` to `most` times the noise (signal units). The targets lie in
  /// [`from_m`, `to_m`], which should be some cells of the waveform.
  LoneEcho(double least, double most, double noise, float from_m, float to_m, const Detect& detect);

  bool covers(float ratio) const { return ratio >= least_ && ratio <= most_; }
  /// Draws the echo of a return, of which `ratio` is the signal over the noise and is covered.
  Echo draw(const LoneReturn& of, float ratio, uint64_t key) const;

 private:
  static constexpr size_t kValues = 4;  // error of the range (m), width (m); peak, energy / signal
  /// The means of these values, and the Cholesky factor of their covariance row by row.
  struct Moments {
    std::array<float, kValues> mean;
    std::array<float, kValues*(kValues + 1) / 2> root;
  };

  float least_ = std::numeric_limits<float>::infinity(), most_ = 0;
  float first_log2_ = 0;
  std::vector<Moments> nodes_;  ///< Moments at equal steps of the ratio's logarithm.
};

}  // namespace underbrush::radiometry
