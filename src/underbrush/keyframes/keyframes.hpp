/// \file
/// Keyframes of a log: some of its scans, kept as range images, and how far they are to be trusted.
#pragma once
#include "underbrush/core/beam_log.hpp"
#include "underbrush/credit/held_out.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// Keyframes: images of a few scans that a model keeps, which answer beams fired near them.
namespace keyframes {

/// The options of `learn_keyframes`.
struct KeyframeOptions {
  /// m; a scan becomes a keyframe where fewer than 16 keyframes lie nearer. 0 = no keyframes.
  double spacing_m = 2;
  /// Returns nearer than this (m) are unknown, because they are of the vehicle.
  double min_range_m = 0;
  /// The most memory that they may take, bytes. Until they fit, fewer may lie nearer, at least 2,
  /// and then the spacing grows.
  size_t most_bytes = size_t(1) << 28;
  /// Beams that the trust is learnt from, in each half of the columns if the log has one scan.
  size_t samples = 60'000;
  /// The beams that the elements were not learnt from. The trust is learnt from them alone where
  /// they are at least a quarter of `samples`, since the elements know their own beams too well.
  credit::HeldOut held_out{0};
};

/// Keeps keyframes of a log in its model. The trust in each situation (`elements::KeyframeTrust`)
/// is learnt by expectation and maximisation from beams of the log: a beam looks at keyframes other
/// than its own scan, at several distances, and the weights are those that make its outcome
/// likeliest beside the answer of the model's elements. Where too few beams were so near to a
/// keyframe, the trust is that of the next farther distance; beyond the farthest one that beams
/// looked at nothing is trusted, and a log too short to trust anything gives no keyframes. Where
/// the log has one scan only, the beams of each half of its columns look at an image of the other
/// half, between whose columns they lie, and the weight of the elements is then lowered, as the
/// columns of the whole image are twice as near. The log is read three times, eight times if it has
/// one scan. The result has the same bits for any number of threads.
void learn_keyframes(elements::Model& model, BeamSource& log, const KeyframeOptions& options);

/// What an update did to the keyframes of a model.
struct KeyframeChanges {
  size_t kept = 0, added = 0;   ///< Keyframes of the earlier logs and of the new scans.
  size_t forgotten_pixels = 0;  ///< Pixels of earlier logs that became unknown.
};

/// Adds keyframes of new scans to those that a model has. Earlier ones stay, but for the pixels
/// whose beams met an ellipsoid of `changed`, which later beams contradict: these become unknown.
/// Both are chosen among as among the scans of one log. The trust is learnt from beams of the new
/// scans, which look at both; at distances at which too few did, it stays as it was. A model
/// without keyframes gets those of the new scans as by `learn_keyframes`.
KeyframeChanges update_keyframes(elements::Model& model, BeamSource& log,
                                 const KeyframeOptions& options, const elements::Model& changed);

}  // namespace keyframes
}  // namespace underbrush
