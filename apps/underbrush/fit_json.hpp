/// \file
/// The report of a fit as JSON, whose keys other programs rely on.
#pragma once
#include "stages.hpp"

namespace underbrush::app {

/// Returns the steps of a refinement, for the manifest and `--json`.
Json json_of(const likelihood::LikelihoodReport& report);
/// Returns the number of range offsets, their spread and that of their standard errors.
Json json_of(const ChannelOffsets& channels);
/// The same as a line of text; nothing without offsets.
std::string text_of_channels(const ChannelOffsets& channels);
/// Returns the size of the keyframes, and at which distances how much of an answer is theirs.
Json json_of(const elements::Keyframes& keyframes);
/// The same as a line of text; nothing for a model without keyframes.
std::string text_of_keyframes(const elements::Model& model);
/// Returns the counts, warnings and times of a fit.
Json json_of(const FitStep& step);

}  // namespace underbrush::app
