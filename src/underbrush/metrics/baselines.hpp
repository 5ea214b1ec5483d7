/// \file
/// The scores of baselines without a model, which a simulator must beat.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/metrics/score.hpp"

namespace underbrush::metrics {

/// Opens a log, so that it can be read more than once at a time.
using OpenLog = std::function<std::unique_ptr<BeamSource>()>;

/// The scores of a baseline.
struct Baseline {
  std::string name;  ///< "always hit" or "look-up".
  Score score;
};

/// A function that gets the real log and the answers of a baseline to the same beams.
using UseBaseline =
    std::function<void(const std::string& name, BeamSource& real, BeamSource& simulated)>;

/// Answers the beams of a log by each baseline. *Always hit* (`AlwaysHit`) takes the medians of
/// the rings from the training log where there is one, and else from the real log itself.
/// *Look-up* (`LookUp::kWarped2`) is left out where `train` is empty; otherwise both logs are held
/// in memory.
void answer_by_baselines(const OpenLog& real, const OpenLog& train, const UseBaseline& use);

/// Scores the baselines (`answer_by_baselines`). The clouds of *always hit* are not compared.
std::vector<Baseline> score_baselines(const OpenLog& real, const OpenLog& train,
                                      const ScoreOptions& options = {});

}  // namespace underbrush::metrics
