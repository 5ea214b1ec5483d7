/// \file
/// Observed space on disk: a PLY file of blocks, and an object of the model's manifest.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "underbrush/elements/observed_space.hpp"
#include "underbrush/io/json_file.hpp"

namespace underbrush::elements {

/// The name of the PLY file in a model's folder.
inline constexpr const char* kObservedSpaceFile = "observed_space.ply";

/// Writes the blocks and their cells.
void write_observed_space(const std::filesystem::path& folder, const ObservedSpace& space);
/// Returns the object of the manifest as JSON: the size of the cells and the densities.
std::string manifest_of_observed_space(const ObservedSpace& space);
/// Reads observed space by its object in a manifest. Throws `FormatError`.
std::shared_ptr<const ObservedSpace> read_observed_space(const io::JsonValue& manifest);

}  // namespace underbrush::elements
