/// \file
/// Holding out a part of a log, so that training and test never share a beam.
#pragma once
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "cli/verb.hpp"

namespace underbrush::app {

/// What is held out: one of `every`, `columns`, `time` and `region`.
struct HoldOut {
  int every = 0;             ///< Every K-th scan.
  int columns = 0;           ///< Every K-th column of each scan.
  int offset = 1;            ///< Number (mod K) that is held out, with `every` and `columns`.
  std::vector<double> time;  ///< Scans from `time[0]` to before `time[1]`, s after the log's start.
  std::vector<double> region;  ///< Scans whose sensor stands in x0 y0 x1 y1, m.
};

/// Beams of each part; `skipped` counts records of the log left out, by reason.
struct SplitStep {
  size_t train_beams = 0, test_beams = 0;
  std::map<std::string, size_t> skipped;
};

/// Writes the beams that are kept for fitting to `train` and those held out to `test`. Throws
/// `std::invalid_argument` where not one of the four is chosen or the log lacks what the choice
/// needs, `FormatError` where a part would be empty.
SplitStep split_log(const Verb& verb, const std::filesystem::path& log, const HoldOut& hold_out,
                    const std::filesystem::path& train, const std::filesystem::path& test);

}  // namespace underbrush::app
