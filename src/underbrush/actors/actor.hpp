/// \file
/// Actors: things that move as models with trajectories, and the folders that hold them.
#pragma once
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/perception/log_truth.hpp"

namespace underbrush::actors {

/// A model that moves. A thing that changes its shape, such as a walking person, is several actors
/// of one name that follow one another in time.
struct Actor {
  std::string name;               ///< For example "van-1".
  std::string label = "unknown";  ///< Its class, such as "van".
  elements::Model model;          ///< Its origin is zero: the middle of the actor's box.
  Trajectory world_from_actor;
  double from_s = -std::numeric_limits<double>::infinity();  ///< s; start of its presence.
  double to_s = std::numeric_limits<double>::infinity();     ///< s; end of its presence, excluded.
  uint32_t instance = 0;  ///< Number of the instance of its scene that it is, or is a copy of.
};

/// Reads a model's folder, or a mesh from an OBJ or PLY file, as a thing that moves. Throws
/// `FormatError`.
elements::Model read_mover(const std::filesystem::path& path);

/// The same model with its origin at zero, where an instance or a trajectory places it. It has
/// neither keyframes nor a map of observed space, which are of a place in the world.
elements::Model at_zero(elements::Model model);

/// Writes actors as a scene in which all instances move (`elements::write_scene`). `provenance` is
/// a JSON object.
void write_actors(const std::filesystem::path& folder, const std::vector<Actor>& actors,
                  const std::string& provenance);

/// Reads the folder of a scene. Throws `FormatError`, also for a scene in which an instance does
/// not move.
std::vector<Actor> read_actor_folder(const std::filesystem::path& folder);

/// The distinct names of actors, in order.
std::vector<std::string> names_of(const std::vector<Actor>& actors);
/// The actors that are present at the times of the scans of a log, as the true objects
/// of these scans. Object k + 1 has the k-th name of `names_of`, and its box is that
/// about the actor's elements. Throws `DataError` for a log without the times of its
/// scans.
perception::LogTruth truth_of(const std::vector<Actor>& actors, const LogInfo& log);

}  // namespace underbrush::actors
