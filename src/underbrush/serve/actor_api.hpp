/// \file
/// The moving things of a scene, with edits: docs/reference/serve-api.md.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/serve/opened_files.hpp"
#include "underbrush/serve/world_data.hpp"

namespace underbrush::serve {

/// Describes the moving things of a scene as JSON, after edits: for each name the class, the report
/// of its learning, and its parts with their poses relative to the origin; and in `list` the edits
/// as the content of a file. `edits` is such a content, or a JSON list of edits, or "" for none.
/// Errors call the edits `place`: `FormatError` for edits that cannot be applied, and
/// `std::invalid_argument` for those that name files.
std::string actors_json(const WorldData& world, const std::string& edits, const std::string& place);

/// Writes edits of the actors of `scene` as a file that `actors::read_actors` reads, if they can be
/// applied and nothing in the scene stands still. Throws as `actors_json` does, and `IoError`.
void write_edits(const std::filesystem::path& path, const OpenedFile& scene, const WorldData& world,
                 const std::string& edits);

}  // namespace underbrush::serve
