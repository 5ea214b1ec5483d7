/// Composition of scenes from primitives, for every verb that composes.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "cli/verb.hpp"
#include "underbrush/primitives/compose.hpp"

namespace underbrush::app {

/// Help of the option --allow-outside.
inline constexpr const char* kAllowOutsideHelp =
    "Follow paths of the annotation that lead out of its folder";

/// The name for the set of primitives of generated plants, with which the comparison simulator of
/// [tallavajhula18] §V composes.
inline constexpr const char* kMeshPrimitives = "mesh_primitives";

/// A set of primitives that the command line names.
struct NamedSet {
  primitives::PrimitiveSet set;
  std::vector<std::filesystem::path> inputs;  ///< Folders that the set was read from.
  std::vector<std::string> warnings;
};

/// Reads the set in the folder `name`. The name `mesh_primitives` always means the set that `meshes
/// generated` writes with that seed and no other option. A folder of that name must be written as
/// `./mesh_primitives`; a set in it gives a warning. Throws `FormatError`.
NamedSet primitives_named(const std::string& name, uint64_t seed);

/// Calls `primitives::compose` and shows the progress.
primitives::Composition composed(const primitives::Annotation& annotation,
                                 const elements::Model& ground, const primitives::PrimitiveSet& set,
                                 const primitives::ComposeOptions& options);

/// Returns counts of what was placed and left out, as JSON.
Json json_of(const primitives::Composition& c);
/// Returns counts of what was placed and left out, as text.
std::string text_of(const primitives::Composition& c);

}  // namespace underbrush::app
