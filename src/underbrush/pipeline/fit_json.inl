// The reports of fits as JSON, whose keys other programs rely on. This file is for sources that use
// JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/log_contents.hpp"

namespace underbrush::pipeline {

/// Returns the number of range offsets, their spread and that of their standard errors.
nlohmann::ordered_json json_of(const ChannelOffsets& channels);
/// Returns the size of the keyframes, and at which distances how much of an answer is theirs.
nlohmann::ordered_json json_of(const elements::Keyframes& keyframes);
/// Returns the light of a model in short: mean reflectances by kind, an element counting once and
/// as often as it was hit, the response to range, and the gains of channels; null without light.
nlohmann::ordered_json json_of_light(const elements::Model& model);
/// Returns the counts and parameters of a model; of a part of one, the counts of the whole.
nlohmann::ordered_json json_of_model(const elements::Model& model);
/// Returns the counts, warnings and times of a fit. `skipped` has the records of the log that were
/// left out, by reason.
nlohmann::ordered_json json_of(const FittedModel& fitted, const SkippedRows& skipped);
/// Returns the counts, warnings and times of an update.
nlohmann::ordered_json json_of(const UpdatedModel& updated, const SkippedRows& skipped);

}  // namespace underbrush::pipeline
