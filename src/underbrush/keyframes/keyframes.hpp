/// \file
/// Keyframes of a log: some of its scans, kept as range images, and their weights.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/keyframes/keyframe_options.hpp"

namespace underbrush {
/// Keyframes: images of a few scans that a model keeps, which answer beams fired near them.
namespace keyframes {

/// Keeps keyframes of a log in its model. The weights in each situation
/// (`elements::KeyframeWeights`) are learnt by expectation and maximisation from beams of the log:
/// each beam is looked up in keyframes other than its own scan, at several distances, and the
/// weights maximise the likelihood of its outcome under the mixture with the model's elements. If
/// too few beams were looked up at a distance, the weights are those of the next farther distance.
/// Beyond the farthest distance that was sampled, keyframes have no weight, and a log from which no
/// weights can be learnt gives no keyframes. If the log has only one scan, the beams of each half
/// of its columns are looked up in an image of the other half, between whose columns they lie. The
/// weight of the elements is then lowered, because the columns of the whole image are twice as
/// near. The log is read three times, eight times if it has one scan. The result has the same bits
/// for any number of threads.
void learn_keyframes(elements::Model& model, BeamSource& log, const KeyframeOptions& options);

/// The changes of the keyframes of a model by an update.
struct KeyframeChanges {
  size_t kept = 0, added = 0;   ///< Keyframes of the earlier logs and of the new scans.
  size_t forgotten_pixels = 0;  ///< Pixels of earlier logs that became unknown.
};

/// Adds keyframes of new scans to those that a model has. The earlier keyframes stay, except that
/// pixels become unknown whose beams met an ellipsoid of `changed`, which later beams contradict.
/// Earlier keyframes and new scans are selected by the same rule as the scans of one log. The
/// weights are learnt from beams of the new scans, which are looked up in all keyframes; at
/// distances with too few beams they do not change. A model without keyframes gets those of the new
/// scans as by `learn_keyframes`.
KeyframeChanges update_keyframes(elements::Model& model, BeamSource& log,
                                 const KeyframeOptions& options, const elements::Model& changed);

}  // namespace keyframes
}  // namespace underbrush
