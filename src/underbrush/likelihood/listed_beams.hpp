/// \file
/// The beams of a log in the form that passes over it need.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/credit/held_out.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/likelihood/pass_kernel.hpp"

namespace underbrush::likelihood {

/// The beams of a log in the frame of a model: those that are held out, and the training beams in
/// blocks.
class ListedBeams {
 public:
  /// Reads the log once. All held-out beams stay in memory, and training beams as long as they take
  /// at most `most_bytes`; further ones are read in each pass. The source must outlive the lists.
  /// Of the model, only the frame and the maximum range count.
  ListedBeams(BeamSource& source, const credit::HeldOut& held_out, const elements::Model& model,
              size_t most_bytes);

  /// The held-out beams of a log whose `training_beams` training beams are not in the lists.
  ListedBeams(const LogInfo& info, std::vector<ListedBeam> held_out, size_t training_beams);

  const LogInfo& info() const { return info_; }
  const std::vector<ListedBeam>& held_out() const { return held_out_; }
  /// The held-out beams by which models are compared: about 2¹⁶ of many, chosen by a hash.
  const std::vector<ListedBeam>& validation() const {
    return validation_.empty() ? held_out_ : validation_;
  }
  /// The number of held-out beams that returned.
  size_t held_out_hits() const;
  size_t training_beams() const { return training_beams_; }
  /// Calls `use` with the training beams of a share, those of each chunk of the log.
  void for_each(credit::BeamShare share,
                const std::function<void(std::span<const ListedBeam>)>& use) const;

 private:
  /// Training beams of a chunk and their numbers (`BeamShare::number_of`).
  struct Block {
    std::vector<ListedBeam> beams;
    std::vector<uint8_t> number;
  };
  /// Appends beams of a chunk, those that are held out to `held_out` unless it is null.
  Block block_of(const BeamLog& chunk, std::vector<ListedBeam>* held_out) const;

  void choose_validation();

  BeamSource* source_ = nullptr;
  LogInfo info_;
  credit::HeldOut rule_;
  Vec3 origin_ = Vec3::Zero();
  double most_range_m_ = 0;
  std::vector<Block> kept_;  ///< The first blocks of training beams.
  std::vector<ListedBeam> held_out_;
  std::vector<ListedBeam> validation_;  ///< Empty where all held-out beams are validation beams.
  size_t training_beams_ = 0;
  bool complete_ = true;  ///< Whether `kept_` has all blocks.
};

}  // namespace underbrush::likelihood
