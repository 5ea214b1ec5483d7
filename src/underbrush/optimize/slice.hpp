/// \file
/// This file takes a slice of a log for tuning, and divides it into a part to fit and a part to
/// validate.
#pragma once
#include "underbrush/core/beam_log.hpp"

namespace underbrush::optimize {

/// Options of `take_slice`.
struct SliceOptions {
  double from_s = 0, to_s = 10;  ///< Time since the log's first beam; 10 s as in [tallavajhula18].
  unsigned one_in = 4;           ///< One scan in this many validates.
  uint64_t seed = 1;             ///< For the choice of columns.
};

/// The sizes of a slice.
struct SliceFacts {
  size_t scans = 0, fitted_beams = 0, judging_beams = 0;
  bool by_scan = true;  ///< Whether whole scans validate, and not columns of each scan.
};

/// Two parts of a log that share no beam.
struct Slice {
  BeamLog fit, validation;
  size_t scans = 0;
  bool by_scan = true;  ///< As in `SliceFacts`.

  SliceFacts facts() const { return {scans, fit.size(), validation.size(), by_scan}; }
};

/// Takes the scans whose first beam was fired in [from_s, to_s). Every `one_in`-th of them
/// validates, and the others are for fitting. Where there are fewer scans than `one_in`, groups of
/// neighbouring beams of each scan validate instead (`credit::HeldOut`). The slice is held in
/// memory. Throws `std::invalid_argument` where a part has no beam.
Slice take_slice(BeamSource& source, const SliceOptions& options);

}  // namespace underbrush::optimize
