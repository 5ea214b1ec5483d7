/// \file
/// The answers of baselines without a model, which a simulator must beat.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// Opens a log, so that it can be read more than once at a time.
using OpenLog = std::function<std::unique_ptr<BeamSource>()>;

inline constexpr const char* kAlwaysHit = "always hit";
inline constexpr const char* kLookUp = "look-up";

/// A function that gets the real log and the answers of a baseline to the same beams.
using UseBaseline =
    std::function<void(const std::string& name, BeamSource& real, BeamSource& simulated)>;

/// Answers the beams of a log by each baseline. *Always hit* (`AlwaysHit`) takes the medians of
/// the rings from the training log where there is one, and else from the real log itself.
/// *Look-up* (`LookUp::kWarped2`) is left out where `train` is empty; otherwise both logs are held
/// in memory.
void answer_by_baselines(const OpenLog& real, const OpenLog& train, const UseBaseline& use);

}  // namespace underbrush::metrics
