/// \file
/// Sources of plant meshes: files, folders of files, or the generator.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/plant_meshes/mesh_primitives.hpp"
#include "underbrush/worlds/mesh_world.hpp"

namespace underbrush::pipeline {

/// Returns the plants from which test sites of that seed are grown: trees, shrubs, tussocks. A
/// `variation` above 1 changes the species (`test_site::make_prototypes`).
std::vector<plant_meshes::PlantSource> generated_plants(uint64_t seed, double variation = 1);

/// Returns the plants of a file, or of all mesh files below a folder in order of name. A file in a
/// folder that is named like a class stands for that class at its own size. Throws `FormatError`,
/// also for a folder without meshes.
std::vector<plant_meshes::PlantSource> plants_of_files(const std::filesystem::path& path,
                                                       const worlds::MeshOptions& options);

}  // namespace underbrush::pipeline
