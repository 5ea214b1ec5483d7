/// \file
/// The evaluations of a search on disk, so that it can be taken up again.
#pragma once
#include <filesystem>

#include "underbrush/optimize/search.hpp"

namespace underbrush::optimize {

/// A search as far as it went.
struct Checkpoint {
  std::string run;  ///< JSON object: all that makes the search what it is, but for its budget.
  bool finished = false;
  std::vector<Evaluation> evaluations;
};

/// Writes the file, whole or not at all. Throws `IoError`.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Reads it. Throws `FormatError`.
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace underbrush::optimize
