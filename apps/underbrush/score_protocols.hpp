/// The scores of the protocols of `score` as text.
#pragma once
#include <string>

#include "underbrush/pipeline/score_logs.hpp"

namespace underbrush::app {

/// Returns the scores of the protocols, of simulated logs and baselines side by side; empty where
/// none was asked for.
std::string text_of_protocols(const pipeline::Scores& scores);

}  // namespace underbrush::app
