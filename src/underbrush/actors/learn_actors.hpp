/// \file
/// Actors learnt from a log: from tracks to models with trajectories.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/actors/actor.hpp"
#include "underbrush/actors/registration.hpp"
#include "underbrush/actors/track.hpp"
#include "underbrush/core/option.hpp"

namespace underbrush::actors {

/// The options of `learn_actors` and `find_tracks`.
struct ActorOptions {
  double boxes_elevation_deg = 0;  ///< deg; elevation by which labelled boxes are turned.
  BoxOptions boxes;
  RegistrationOptions registration;
  size_t least_returns = 30;    ///< An actor with fewer returns is left out.
  double walk_s = 0.5;          ///< s; a pedestrian is rigid for this time.
  bool poses_as_given = false;  ///< Whether the poses stay those of the boxes.
  bool one_sided = false;       ///< Whether a side from which no beam came stays empty.
};

/// The table of these options.
std::span<const Option<ActorOptions>> actor_options();

/// The result of learning from one track.
struct ActorReport {
  std::string name, label;
  size_t scans = 0, returns = 0;
  size_t passed = 0;         ///< Beams that entered its box and did not end at it.
  size_t mirrored = 0;       ///< Ellipsoids that were added (`complete_by_symmetry`).
  size_t models = 0;         ///< 0 for a track that is left out.
  RegistrationReport views;  ///< The agreement of the views of the last model.
};

/// Actors, and the result for each track.
struct LearntActors {
  std::vector<Actor> actors;
  std::vector<ActorReport> report;  ///< One for each track.
};

/// Fits a model to the beams that meet an actor, which are in the actor's frame.
using FitActor = std::function<elements::Model(const BeamLog&)>;

/// Learns an actor of each track: its beams are gathered (`views_of`), their poses are refined
/// (`register_views`), the beams are moved to the actor's frame, and `fit` makes a model of them,
/// which of vehicles and cyclists is completed (`complete_by_symmetry`). A pedestrian becomes
/// several actors of one name, each for at least `walk_s`. Tracks with fewer than `least_returns`
/// returns, or with returns in one scan only, are left out. The log has one row per beam and is
/// read once, from the beginning. Throws what `fit` throws.
LearntActors learn_actors(BeamSource& log, const std::vector<Track>& tracks,
                          const ActorOptions& options, const FitActor& fit,
                          const std::function<void(size_t, size_t)>& progress = {});

/// Finds tracks without labels: returns that moved (the flag `kMover`, or those of
/// `movers::find_movers` in a log without that flag) and tracked objects of the real pipeline
/// (`perception::perceived`). The tracks are those of objects at least half of whose returns moved,
/// that have `least_returns`, and that moved on by at least a metre. The log is read several times.
/// Throws `DataError` for a log that cannot be tracked.
std::vector<Track> find_tracks(BeamSource& log, const ActorOptions& options);

/// Returns the tracks of a log, which messages call `file`: those of the file `boxes`, which has
/// labelled boxes or lists of objects, or else those of `find_tracks`. The log has one row per
/// beam. Throws `FormatError`, also where there are no tracks.
std::vector<Track> tracks_of_log(BeamSource& log, const std::string& file,
                                 const std::filesystem::path& boxes, const ActorOptions& options);

/// Marks the returns of tracks (`kMover`) in a chunk of a log; other marks stay. Returns how many
/// returns are those of tracks.
size_t mark_returns(BoxesOfBeams& boxes, BeamLog& chunk);

/// The beams of a chunk that enter the box of a track, with the margin, or end in it.
BeamLog beams_on(BoxesOfBeams& boxes, const BeamLog& chunk);

}  // namespace underbrush::actors
