/// \file
/// What verbs print of fits, updates and models.
#pragma once
#include <string>

#include "underbrush/pipeline/fit_json.inl"

namespace underbrush::app {

/// Returns a line on the range offsets of channels; nothing without offsets.
std::string text_of_channels(const ChannelOffsets& channels);
/// Returns a line on the keyframes; nothing for a model without keyframes.
std::string text_of_keyframes(const elements::Model& model);
/// Returns the counts of a fit. `skipped` has the records of the log that were left out, by reason.
std::string text_of(const pipeline::FittedModel& fitted, const pipeline::SkippedRows& skipped);
/// Returns the counts of an update.
std::string text_of(const pipeline::UpdatedModel& updated, const pipeline::SkippedRows& skipped);

}  // namespace underbrush::app
