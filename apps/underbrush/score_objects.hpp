/// \file
/// The verb `score` for lists of objects.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/verb.hpp"

namespace underbrush::app {

/// The files of lists that are compared.
struct ObjectScoreArguments {
  std::filesystem::path real;
  std::vector<std::string> simulated, names;
  std::string truth, report;  ///< Empty where there is none.
};

/// Compares lists with a real one, and all with the truth, and reports the results.
void score_objects(const Verb& verb, const ObjectScoreArguments& a);

}  // namespace underbrush::app
