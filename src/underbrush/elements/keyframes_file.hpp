/// \file
/// Keyframes on disk: a PLY file of pixels and columns, and an object of the model's manifest.
#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "underbrush/elements/keyframes.hpp"
#include "underbrush/io/json_file.hpp"

namespace underbrush::elements {

/// The name of the PLY file in a model's folder.
inline constexpr const char* kKeyframesFile = "keyframes.ply";

/// Writes the pixels and the origins of the columns.
void write_keyframes(const std::filesystem::path& folder, const Keyframes& keyframes);
/// Returns the object of the manifest as JSON: image, poses and weights.
std::string manifest_of_keyframes(const Keyframes& keyframes);
/// Reads keyframes by their object in a manifest. Throws `FormatError`.
std::shared_ptr<const Keyframes> read_keyframes(const io::JsonValue& manifest);

}  // namespace underbrush::elements
