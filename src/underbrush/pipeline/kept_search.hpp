/// \file
/// A search for parameters whose evaluations are kept in a file, so that one that was killed can go
/// on.
#pragma once
#include <string>
#include <vector>

#include "underbrush/pipeline/tune.hpp"

namespace underbrush::pipeline {

/// The file of a search, and what its results depend on besides the problem and the options.
struct SearchFile {
  std::filesystem::path path;
  bool resume = false;              ///< Whether the search goes on from the file, if there is one.
  std::string program;              ///< Name and version.
  std::vector<std::string> inputs;  ///< The hashes of the files that are read.
  std::string fixed = "{}";         ///< The options of the fit that are not tuned (JSON).
};

/// A search that has ended.
struct KeptSearch {
  std::vector<optimize::Evaluation> evaluations;
  size_t resumed = 0;  ///< Evaluations that the file held.
};

/// Minimises as `tune` does, and writes the file after each evaluation. The budget alone may differ
/// from that of the search that goes on. Throws `std::invalid_argument` where the file holds a
/// search that did not end and `resume` is not set, `FormatError` where it is damaged or of another
/// search, `IoError`, and as `tune` does.
KeptSearch tune_and_keep(
    const TuningProblem& problem, const optimize::TuneOptions& options, const SearchFile& file,
    const std::function<void(std::span<const optimize::Evaluation>)>& after = {});

/// Notes in the file of a search that it has ended, so that the next one may replace it. Whoever
/// writes the result does so before. Throws as `tune_and_keep` does.
void end_search(const SearchFile& file);

}  // namespace underbrush::pipeline
