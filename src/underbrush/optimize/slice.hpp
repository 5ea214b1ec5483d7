/// \file
/// The part of a log on which parameters are tuned, cut into what is fitted and what judges.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::optimize {

/// Options of `take_slice`.
struct SliceOptions {
  double from_s = 0, to_s = 10;  ///< Time since the log's first beam; 10 s as in [tallavajhula18].
  unsigned one_in = 4;           ///< One scan in so many validates.
  uint64_t seed = 1;             ///< Of the choice of columns.
};

/// Two parts that share no beam.
struct Slice {
  BeamLog fit, validation;
  size_t scans = 0;
  bool by_scan = true;  ///< Whole scans validate; else columns of each.
};

/// Scans whose first beam was fired in [from_s, to_s). Every `one_in`-th of them validates, the
/// others are fitted. Where there are fewer scans than `one_in`, groups of neighbouring beams of
/// each scan are drawn instead (`fit::HeldOut`). Holds the slice in memory. Throws
/// `std::invalid_argument` where a part has no beam.
Slice take_slice(BeamSource& source, const SliceOptions& options);

}  // namespace underbrush::optimize
