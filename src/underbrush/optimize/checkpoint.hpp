/// \file
/// This file stores the evaluations of a search, so that the search can be resumed.
#pragma once
#include <filesystem>

#include "underbrush/optimize/search.hpp"

namespace underbrush::optimize {

/// The state of a search.
struct Checkpoint {
  std::string run;  ///< JSON object of all that defines the search, except its budget.
  bool finished = false;
  std::vector<Evaluation> evaluations;
};

/// Writes the file, whole or not at all. Throws `IoError`.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Reads a checkpoint. Throws `FormatError`.
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace underbrush::optimize
