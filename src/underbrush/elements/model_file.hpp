/// \file
/// Models on disk: a folder with a small JSON manifest and PLY files that standard tools read.
/// Layout: docs/reference/formats.md.
#pragma once
#include <filesystem>
#include <functional>

#include "underbrush/elements/model.hpp"

namespace underbrush::elements {

/// Version of the layout that is written. Older versions are read, newer ones refused.
inline constexpr int kModelVersion = 1;

/// Writes the folder `path` (model.json, ground.ply, surface.ply, ellipsoids.ply and, where the
/// model has keyframes, keyframes.ply), atomically, replacing a model that stood there. `besides`,
/// where given, is called with the folder that will become the model and may write more into it.
/// Throws `IoError`, also if a folder that is not a model stands there.
void write_model(const std::filesystem::path& path, const Model& model,
                 const std::function<void(const std::filesystem::path&)>& besides = {});

/// Throws the `IoError` that `write_model` would end with. Callers use it before a long
/// computation.
void check_model_output(const std::filesystem::path& path);

/// Reads a model folder. Throws `FormatError` for anything that is not a whole, consistent model.
Model read_model(const std::filesystem::path& path);

/// Whether `path` is a model folder, which has a manifest.
bool is_model(const std::filesystem::path& path);

/// Writes the ellipsoids as a 3-D Gaussian splat PLY (x y z, f_dc, opacity as logit, scale as log,
/// rotation as quaternion w x y z) for splat viewers. Coordinates are relative to the model's
/// origin; colours show the hit probability. Throws `IoError`.
void write_splat(const std::filesystem::path& path, const Model& model);

/// Writes a mesh as Wavefront OBJ (extension .obj) or PLY. Coordinates are relative to the model's
/// origin. Throws `IoError`.
void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace underbrush::elements
