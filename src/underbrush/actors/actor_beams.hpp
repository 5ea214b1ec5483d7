/// \file
/// The beams that meet the boxes of tracks.
#pragma once
#include <vector>

#include "underbrush/actors/track.hpp"

namespace underbrush::actors {

/// The beams that meet an actor in one scan.
struct View {
  double time_s = 0;      ///< Mean time of the actor's returns, s.
  Pose world_from_actor;  ///< Origin in the middle of the actor's box, x along its length.
  BeamLog beams;          ///< World frame; a beam that did not end at the actor is a miss.
  size_t returns = 0;     ///< The number of beams that ended at the actor.
};

/// Gathers the beams that meet the boxes of each track (with the margin), scan by scan. Scans in
/// which no beam ended at the actor have no view. The log is read once, from the beginning; it has
/// one row per beam. Throws `DataError` where two scans share one time.
std::vector<std::vector<View>> views_of(BeamSource& log, const std::vector<Track>& tracks,
                                        const BoxOptions& options);

/// The poses of two or more views over time. The trajectory goes on, at the speed at its ends, for
/// half the usual time between views.
Trajectory trajectory_of(const std::vector<View>& views);

/// The beams of views in the actor's frame, each moved by the pose at the beam's own time.
BeamLog in_actor_frame(const std::vector<View>& views, const Trajectory& world_from_actor);

}  // namespace underbrush::actors
