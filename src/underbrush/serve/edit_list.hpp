/// \file
/// A list of edits of actors, named in place of the folder of these.
#pragma once
#include <filesystem>
#include <string>

namespace underbrush::serve {

/// A list of edits of actors.
struct GivenEdits {
  std::filesystem::path actors;  ///< The folder that is edited, with all links resolved.
  std::string list;              ///< The content of the file; "" for none.
};

/// Reads a list of edits. Throws as `actors::read_actors` does, and `std::invalid_argument` for
/// edits that name files.
GivenEdits read_edits(const std::filesystem::path& file);

}  // namespace underbrush::serve
