/// \file
/// The verb `meshes`: plant meshes in, a set of primitives out.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/pipeline/plants.hpp"
#include "underbrush/primitives/primitive_set.hpp"

namespace underbrush::pipeline {

/// The options of `meshes`.
struct MeshesOptions {
  double variation = 1;                       ///< The variation of the generated species.
  worlds::MeshOptions files;                  ///< The options for reading the files.
  plant_meshes::MeshPrimitiveOptions meshes;  ///< The seed is also that of generated plants.
};

/// The options of `meshes`.
std::span<const Option<MeshesOptions>> meshes_options();

/// Primitives that are made of plant meshes.
struct MeshSet {
  std::vector<primitives::Primitive> primitives;
  size_t plants = 0;
  double least_scale = 1, most_scale = 1;     ///< The factors by which the plants were scaled.
  std::vector<std::filesystem::path> inputs;  ///< The files that were read.
};

/// Makes primitives of plants: each word names a file of meshes, a folder of such files, or is
/// `generated` for the plants of the demo's site. Throws `FormatError`, and `std::invalid_argument`
/// for options out of range.
MeshSet mesh_set(const std::vector<std::string>& plants, const MeshesOptions& options);

}  // namespace underbrush::pipeline
