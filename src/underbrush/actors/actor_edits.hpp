/// \file
/// Edits of actors, one by one, and the files that list them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/actors/actor.hpp"

namespace underbrush::actors {

/// Removes all actors of a name. This and the other edits throw `std::invalid_argument` if there
/// is no actor of the name.
void remove_actor(std::vector<Actor>& actors, const std::string& name);
/// Moves the actors of a name: each pose is followed by `actor_from_moved`, in the actor's own
/// frame at that time (x forwards).
void move_actor(std::vector<Actor>& actors, const std::string& name, const Pose& actor_from_moved);
/// Lets everything that the actors of a name do happen `by_s` (s) later, or earlier if negative.
void delay_actor(std::vector<Actor>& actors, const std::string& name, double by_s);
/// Shifts the trajectories of the actors of a name by `by` (m, world frame); headings stay.
/// `within_s` before and after the time `at_s` (s) the shift fades to nothing as (1 + cos) / 2; for
/// an infinite `within_s` it is the same everywhere.
void shift_actor(std::vector<Actor>& actors, const std::string& name, const Vec3& by, double at_s,
                 double within_s);
/// Adds a copy with another name, which no actor may have.
void copy_actor(std::vector<Actor>& actors, const std::string& name, const std::string& as);
/// Gives the actors of a name another trajectory. A thing of several actors keeps their times;
/// a single actor is there from the first pose to the last.
void redirect_actor(std::vector<Actor>& actors, const std::string& name,
                    const Trajectory& world_from_actor);
/// Gives the actors of a name another model, whose origin is the middle of the actor's box. A thing
/// of several actors becomes one, from the first to the last of their times.
void replace_model(std::vector<Actor>& actors, const std::string& name, elements::Model model);

/// Applies the edits of a list, the content of a file of edits, in their order, to given actors
/// instead of those of the folder that the list names. Error messages call the list `place`, and
/// its paths are relative to the folder of `place`. Throws `FormatError`.
void apply_edits(std::vector<Actor>& actors, const std::string& list,
                 const std::filesystem::path& place);
/// Reads actors: the folder of a scene (`read_actor_folder`), or a list of edits, JSON after the
/// schema share/schemas/actor-edits.json, with the folder of the actors and the edits, which are
/// applied in their order. Throws `FormatError`, with the place of an edit that cannot be applied.
std::vector<Actor> read_actors(const std::filesystem::path& path);

}  // namespace underbrush::actors
