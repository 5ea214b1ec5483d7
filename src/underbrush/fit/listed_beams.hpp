/// \file
/// The beams of a log as passes over it need them.
#pragma once
#include <functional>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/beam_block.hpp"
#include "underbrush/fit/held_out.hpp"

namespace underbrush::fit {

/// The beams of a log in the frame of a model: those that are held out, and the training beams in
/// blocks.
class ListedBeams {
 public:
  /// Reads the log once. All held-out beams stay in memory, and training beams as long as they take
  /// at most `most_bytes`; further ones are read in each pass. The source must outlive the lists.
  /// Of the model, only the frame and the maximum range count.
  ListedBeams(BeamSource& source, const HeldOut& held_out, const elements::Model& model,
              size_t most_bytes);

  const LogInfo& info() const { return source_.info(); }
  const std::vector<ListedBeam>& held_out() const { return judging_; }
  size_t training_beams() const { return training_beams_; }
  /// Calls `use` with each block of training beams in the order of the log. It may fill in the rest
  /// of the block, which is the next one's, too.
  void for_each(const std::function<void(BeamBlock&)>& use) const;

 private:
  std::vector<ListedBeam> beams_of(const BeamLog& chunk, bool held_out) const;

  BeamSource& source_;
  HeldOut rule_;
  Vec3 origin_;
  double most_range_m_;
  std::vector<std::vector<ListedBeam>> kept_;  ///< The first blocks of training beams.
  std::vector<ListedBeam> judging_;
  size_t training_beams_ = 0;
  bool complete_ = true;  ///< Whether `kept_` has all blocks.
};

}  // namespace underbrush::fit
