/// \file
/// The verb `compose`: an annotation and primitives in, a scene out.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/option.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::pipeline {

/// Help of the option --allow-outside of the verbs that read an annotation.
inline constexpr const char* kAllowOutsideHelp =
    "Follow paths of the annotation that lead out of its folder";

/// The options of `compose`.
struct ComposeOptions {
  uint64_t seed = 1;
  std::string choose = "best";  ///< "box", "best" or "random" (`primitives::Choice`).
  size_t nearest = 1;           ///< See `primitives::ComposeOptions`, as for `scale`.
  bool scale = false;
  std::vector<std::string> class_density;  ///< Each is CLASS=FACTOR.
  /// Annotations: no primitive is used that was cut from an object whose box overlaps one of
  /// theirs, as seen from above.
  std::vector<std::string> leave_out;
  bool allow_outside = false;
  bool strict = false;  ///< Whether an object that cannot be placed as annotated is an error.
};

/// The options of `compose`.
std::span<const Option<ComposeOptions>> compose_options();

/// A set of primitives with its name for messages.
struct NamedSet {
  std::string name;
  primitives::PrimitiveSet set;
  std::vector<std::filesystem::path> inputs{};  ///< Folders that the set was read from.
  std::vector<std::string> warnings{};
};

/// Reads the set in the folder `name`. The name `mesh_primitives` always means the set of the
/// generated plants, with which the comparison simulator of [tallavajhula18] §V composes: the set
/// that `meshes generated` writes with that seed and no other option. A folder of that name must be
/// written as `./mesh_primitives`; a set in it gives a warning. Throws `FormatError`.
NamedSet primitives_named(const std::string& name, uint64_t seed);

/// A composed scene, and its inputs.
struct ComposedScene {
  primitives::Composition composition;
  size_t primitives_left_out = 0;             ///< Primitives that `leave_out` excludes.
  std::vector<std::filesystem::path> inputs;  ///< The files and folders that were read.
  std::vector<std::string> warnings;
  double seconds = 0;
};

/// Composes a site in parts and writes it as a world of regions (`regions::compose_world`).
/// `provenance(inputs)` gives its provenance. Throws as `compose_scene` does, and `IoError`.
ComposedScene compose_parts(
    const std::filesystem::path& output, const std::string& site, NamedSet primitives,
    const ComposeOptions& options,
    const std::function<std::string(const std::vector<std::filesystem::path>&)>& provenance,
    const primitives::ComposeProgress& progress = {});

/// Composes a scene along `site` on `ground` (`primitives::compose`). Of the options it takes those
/// that are neither files nor `strict`. `progress(done, total)` may be empty. Throws `DataError`
/// for a model without ground, and `std::invalid_argument` for options out of range.
primitives::Composition compose_scene(const primitives::Annotation& site,
                                      const elements::Model& ground,
                                      const primitives::PrimitiveSet& primitives,
                                      const ComposeOptions& options,
                                      const primitives::ComposeProgress& progress = {});

/// Composes a scene along the annotation in a file, as `compose_scene` of values does. It stands on
/// `ground`, or where that is null on the model in the folder `ground_folder`, or where that is
/// empty on the annotation's. `progress(done, total)` may be empty. Throws `FormatError`,
/// `DataError` and `std::invalid_argument`.
ComposedScene compose_scene(const std::string& annotation, NamedSet primitives,
                            const elements::Model* ground, const std::string& ground_folder,
                            const ComposeOptions& options,
                            const primitives::ComposeProgress& progress = {});

}  // namespace underbrush::pipeline
