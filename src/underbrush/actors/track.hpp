/// \file
/// Boxes of objects sorted by object, and which beams of a scan meet them.
#pragma once
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/perception/log_truth.hpp"

namespace underbrush {
/// Things that move, learnt from a log: models with trajectories, which can be edited one by one.
namespace actors {

/// An object over time, as the sensor measured it.
struct Track {
  uint64_t id = 0;
  perception::ObjectClass label = perception::ObjectClass::kUnknown;
  Vec3 size_m = Vec3::Zero();  ///< Length, width and height: the medians of its boxes.
  std::vector<perception::SeenBox>
      seen;  ///< Boxes in order of time; the times differ, and all sizes are the one above.

  /// Its name in files: the class and the id, such as "van-1".
  std::string name() const;
};

/// Sorts boxes by object. The class is that of an object's first box.
std::vector<Track> tracks_of(std::span<const perception::SeenBox> boxes);

/// Takes the boxes of measured objects from lists of objects, each with the number of the scan of
/// `log` that is nearest in time; in lists that do not distinguish measured from predicted objects,
/// all boxes count. Where the heading turns by more than a right angle from one box to the next, it
/// is taken as the opposite one.
std::vector<perception::SeenBox> boxes_of(std::span<const perception::ObjectList> lists,
                                          const LogInfo& log);

/// The options of `BoxesOfBeams`.
struct BoxOptions {
  double margin_m = 0.3;  ///< m; returns up to this far outside of a box belong to its object.
  /// m; returns up to this height above the bottom of a box are those of the ground.
  double foot_m = 0.15;
};

/// The boxes of tracks at the times of beams, to find the beams that meet them.
///
/// A box is interpolated between the two of its track that are nearest in time, or extrapolated.
/// The box exists up to three quarters of the usual time between boxes from one of them.
class BoxesOfBeams {
 public:
  /// `tracks` must outlive it.
  BoxesOfBeams(const std::vector<Track>& tracks, const BoxOptions& options);

  /// The track whose box holds a return, with the margin and above the foot: of several such
  /// tracks, the one in which the return lies deepest. A miss has no track.
  std::optional<size_t> track_of_return(const BeamLog& log, size_t i);
  /// Replaces `tracks` by those whose boxes, with the margin, a beam enters before its return.
  void tracks_on(const BeamLog& log, size_t i, std::vector<size_t>& tracks);
  /// The box of a track at a time (s), if the track exists at that time.
  std::optional<perception::OrientedBox> box(size_t track, double time_s) const;

 private:
  void look_at(double time_s);

  const std::vector<Track>& tracks_;
  BoxOptions options_;
  std::vector<double> usual_gap_s_;
  double time_s_ = NAN;  ///< The time of the boxes in `now_`, for beams that are fired together.
  std::vector<std::pair<size_t, perception::OrientedBox>> now_;
};

}  // namespace actors
}  // namespace underbrush
