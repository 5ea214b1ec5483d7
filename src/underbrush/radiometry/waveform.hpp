/// \file
/// This file has the received signal over range, which is evaluated only in the blocks that returns
/// reach.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "underbrush/radiometry/response.hpp"

namespace underbrush::radiometry {

/// The sampled signal of one beam, s(r) = Σ a_i h(r − r_i) over its returns, plus noise. Sample k
/// is at `range_m(k)`. The caller chooses the unit of amplitude; in this library it is the standard
/// deviation of the receiver's noise in the dark.
///
/// A thread keeps a waveform from beam to beam. A beam touches only the blocks of samples that its
/// returns reach, and `clear` clears only those. Returns outside [0, max_range] and returns whose
/// amplitude is not positive add nothing. Ranges are rounded to 1/256 cell, without bias.
class Waveform {
 public:
  static constexpr int kBlock = 16;  ///< Samples in a block.

  /// Makes an empty waveform. `response` must outlive it. Throws `std::invalid_argument` for more
  /// than 2²³ samples.
  Waveform(const Response& response, double max_range_m);

  void clear();
  /// Adds returns at `range_m` with the peaks `amplitude`; both spans are equally long.
  void add(std::span<const float> range_m, std::span<const float> amplitude);
  /// Adds normal noise of standard deviation `sigma` to all touched samples, filtered by the
  /// receiver
  /// (`Response::noise_filter`). The noise before the filter comes from a table of 4096 quantiles.
  void add_noise(uint64_t key, float sigma);
  /// Rounds the touched samples to multiples of `step` (0 for no rounding) and cuts them at `most`.
  void quantise(float step, float most);

  /// Calls `f(begin, end)` for each run [begin, end) of touched samples, in order.
  template <class F>
  void for_each_run(F f) const;
  const float* samples() const { return sample_.data(); }
  size_t size() const { return sample_.size(); }
  /// The number of touched samples.
  size_t touched() const;
  /// The number of samples that a return at this range in [0, max_range] would touch alone.
  size_t reach_of(float range_m) const;
  double cell_m() const { return response_.cell_m(); }
  double range_m(double sample) const { return (sample - response_.before()) * cell_m(); }
  const Response& response() const { return response_; }

 private:
  const Response& response_;
  double max_range_m_;
  double places_per_m_;
  float* lane(size_t k) { return lanes_.data() + (k - 1) * sample_.size(); }

  std::vector<float> sample_;
  /// Returns go to four lanes in turn, so that a sum need not wait for the one before. All lanes
  /// are zero between calls.
  std::vector<float> lanes_;
  std::vector<float> white_;      ///< Noise before the filter.
  std::vector<uint64_t> blocks_;  ///< One bit for each block: whether it is touched.
};

/// Makes a table of range (m) and signal, without the gaps between runs.
std::vector<std::pair<double, double>> table_of(const Waveform& waveform);

template <class F>
void Waveform::for_each_run(F f) const {
  size_t begin = 0, end = 0;  // samples of the current run
  for (size_t w = 0; w < blocks_.size(); ++w) {
    for (uint64_t bits = blocks_[w]; bits != 0; bits &= bits - 1) {
      const size_t at = (w * 64 + size_t(__builtin_ctzll(bits))) * kBlock;
      if (at != end) {
        if (end > begin) f(begin, end);
        begin = at;
      }
      end = at + kBlock;
    }
  }
  if (end > begin) f(begin, end);
}

}  // namespace underbrush::radiometry
