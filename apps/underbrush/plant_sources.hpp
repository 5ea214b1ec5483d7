/// Where plant meshes come from: files, folders of files, or the generator.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/primitives/mesh_primitives.hpp"

namespace underbrush::app {

/// How files are to be read.
struct PlantFileOptions {
  double unit_m = 1;  ///< Metres of one unit of length in them.
  bool y_up = false;  ///< Their y axis points up, not z; that of glTF always does.
};

/// The plants that the test sites are grown from, of that seed: trees, shrubs, tussocks. Other
/// species with a `variation` above 1 (`test_site::make_prototypes`).
std::vector<primitives::PlantSource> generated_plants(uint64_t seed, double variation = 1);

/// Plants of a file, or of all files of meshes below a folder, in order of name. A file in a
/// folder with the name of a class stands for that class, as large as it is. Throws `FormatError`,
/// also for a folder without any.
std::vector<primitives::PlantSource> plants_of_files(const std::filesystem::path& path,
                                                     const PlantFileOptions& options);

}  // namespace underbrush::app
