/// \file
/// Surveys on disk: a folder with the scene, and of each leg the sensor and the trajectory.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/worlds/helios_survey.hpp"
#include "underbrush/worlds/mesh_world.hpp"

namespace underbrush::worlds {

/// Throws the `IoError` that `write_survey` would end with.
void check_survey_output(const std::filesystem::path& path);

/// Writes the folder `path`, atomically, replacing a survey that stood there: survey.json, scene/,
/// and leg-N.yaml, leg-N.txt and, if it has a table, leg-N.csv for each leg N. Returns the text of
/// survey.json (JSON). `provenance` is JSON. Throws `FormatError` where the sensor of a leg is one
/// that `sensor::load` refuses, and `IoError`, also if a folder that is no survey stands there.
std::string write_survey(const std::filesystem::path& path, const World& world,
                         const Survey& survey, const std::string& provenance);

}  // namespace underbrush::worlds
