/// \file
/// The verb `split`: a log in, a part for training and a part for tests out, which never share a
/// beam.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/option.hpp"

namespace underbrush::pipeline {

/// The choice of the beams that are held out: one of `every`, `columns`, `time` and `region`.
struct SplitOptions {
  int every = 0;    ///< Every K-th scan; 0 = not given.
  int columns = 0;  ///< Every K-th column of each scan: the beams fired at one time; 0 = not given.
  int offset = 1;   ///< Number (mod K) that is held out, with `every` and `columns`.
  std::vector<double> time;  ///< Scans from `time[0]` to before `time[1]`, s after the log's start.
  std::vector<double> region;  ///< Scans whose sensor stands in x0 y0 x1 y1, m.

  /// Throws `std::invalid_argument` where not one of the four is chosen or a value is out of range.
  void check() const;
};

/// The options of `split`.
std::span<const Option<SplitOptions>> split_options();

/// The beams of each part.
struct SplitCounts {
  size_t train_beams = 0, test_beams = 0;
};

/// Passes the beams that are kept for fitting and those that are held out to `write`, chunk by
/// chunk; one of the two may be empty. `progress(done, total)` may be empty. Throws
/// `std::invalid_argument` for options that `check` refuses and where the log lacks the data that
/// the choice needs, `DataError` where a part would be empty.
SplitCounts split_log(BeamSource& log, const SplitOptions& options,
                      const std::function<void(const BeamLog& train, const BeamLog& test)>& write,
                      const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::pipeline
