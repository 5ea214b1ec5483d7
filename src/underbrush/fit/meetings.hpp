/// \file
/// This file lists which elements each beam of a log may meet, so that a model can be refined in
/// many passes over one search.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/fit/beam_block.hpp"
#include "underbrush/fit/held_out.hpp"
#include "underbrush/fit/rearrangement.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {

/// The meetings of all beams of a log with the elements of a model, as long as no ellipsoid leaves
/// its bounds. These are those of the model at the search, scaled about their centres.
///
/// Whether a beam meets an element is decided anew in each pass, so a pass over the lists has the
/// result of a search in the changed model.
class Meetings {
 public:
  /// Searches `model`, whose ellipsoids may later grow or move to within `scale` ≥ 1 times their
  /// extent. Lists of up to `most_bytes` are kept. What exceeds them is searched again in each
  /// pass. The source must outlive the lists, and is read once.
  Meetings(const elements::Model& model, double scale, BeamSource& source, const HeldOut& held_out,
           size_t most_bytes);
  /// The lists after a rearrangement of the model, without a search. A half is where its whole was,
  /// and where two were merged are the meetings of both.
  Meetings(const Meetings& before, const Rearranged& after);
  ~Meetings();

  /// Whether an ellipsoid (by its place in the model's vector) is within the bounds.
  bool within_bounds(size_t index, const elements::Ellipsoid& e) const;
  /// Lets each ellipsoid of `next` go only so far from its place in `now`, which is within the
  /// bounds, that it stays within them: all the way, half of it and so on. Returns how many were
  /// held back.
  size_t keep_within_bounds(const elements::Model& now, elements::Model& next) const;
  /// Calls `use` with each block in order, and with the number of beams done.
  void for_each(const std::function<void(const BeamBlock&, size_t)>& use) const;
  size_t beams() const { return source_.size(); }
  const LogInfo& info() const { return source_.info(); }

 private:
  BeamBlock search(const BeamLog& chunk) const;

  BeamSource& source_;
  HeldOut held_out_;
  double scale_;
  elements::Model bounds_;  ///< The model at the search, with its τ scaled.
  std::optional<trace::World> world_;
  std::vector<BeamBlock> kept_;
  bool complete_ = true;  ///< Whether all blocks were kept.
};

}  // namespace underbrush::fit
