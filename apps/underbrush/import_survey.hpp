/// The import of surveys of HELIOS++: a folder with the scene, and of each leg the sensor and the
/// trajectory.
#pragma once
#include <filesystem>

#include "cli/verb.hpp"

namespace underbrush::app {

/// Reads the survey (XML) and writes the folder `output`: survey.json, scene/, and leg-N.yaml,
/// leg-N.csv and leg-N.txt for each leg N on which the scanner measures. Files that the survey
/// names are looked for beside it and in the folder `assets`. Throws `FormatError` and `IoError`,
/// also if a folder that is no survey stands there.
void import_survey(const Verb& verb, const std::filesystem::path& survey,
                   const std::filesystem::path& output, const std::filesystem::path& assets);

}  // namespace underbrush::app
