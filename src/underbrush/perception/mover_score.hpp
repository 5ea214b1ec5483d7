/// \file
/// The marks of `movers` compared with labelled boxes.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/perception/log_truth.hpp"

namespace underbrush::perception {

/// Labelled objects of a kind, their returns, and the marked ones among these.
struct MarkedReturns {
  size_t objects = 0, returns = 0, marked = 0;
};

/// The returns in labelled boxes, from 0.4 m above the bottom on, by the class of the object and
/// whether it moved by more than 1 m while it was labelled.
struct MoverScore {
  std::map<std::string, MarkedReturns> moving, standing;
  MarkedReturns elsewhere;  ///< Returns in no box of the scan; boxes may cover a part of the view.
};

/// Scores the marks of a log's rows. Rewinds the log.
MoverScore score_movers(BeamSource& log, const std::vector<uint8_t>& mark, const LogTruth& truth);

}  // namespace underbrush::perception
