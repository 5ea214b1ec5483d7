/// Scenes put together of primitives, for every verb that composes.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/primitives/compose.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

/// The name of the set of primitives of generated plants, with which the comparison simulator of
/// [tallavajhula18] §V composes.
inline constexpr const char* kMeshPrimitives = "mesh_primitives";

/// A set as the command line names it.
struct NamedSet {
  primitives::PrimitiveSet set;
  std::vector<std::filesystem::path> inputs;  ///< Folders that it came from.
  std::vector<std::string> warnings;
};

/// The set in the folder `name`. The name `mesh_primitives` stands for the set that
/// `meshes generated` writes with that seed and no other option, whatever folders there are: one of
/// that name is `./mesh_primitives`, and a set in it gives a warning. Throws `FormatError`.
NamedSet primitives_named(const std::string& name, uint64_t seed);

/// `primitives::compose`, with progress.
primitives::Composition composed(const primitives::Annotation& annotation,
                                 const elements::Model& ground, const primitives::PrimitiveSet& set,
                                 const primitives::ComposeOptions& options);

/// What happened, for people and for programs.
Json json_of(const primitives::Composition& c);
std::string text_of(const primitives::Composition& c);

}  // namespace underbrush::app
