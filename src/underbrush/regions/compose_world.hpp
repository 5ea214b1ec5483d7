/// \file
/// Composition of scenes that are larger than memory.
#pragma once
#include <filesystem>

#include "underbrush/primitives/compose.hpp"
#include "underbrush/regions/site_folder.hpp"

namespace underbrush::regions {

/// Composes a site in parts (`primitives::compose`) and writes a world in which each part is a
/// region. Memory is that of a row of parts. The result has counts, models and their names, and no
/// instances but the ground's. Throws `IoError`, `FormatError` and `std::invalid_argument` as
/// `primitives::compose` does, and for a density above 1, which would place objects beyond a part's
/// ground. Paths that lead out of the annotations' folders are followed if `outside`. `accept` may
/// throw to refuse the composition before the world appears.
primitives::Composition compose_world(
    const std::filesystem::path& path, const SiteFolder& site, const primitives::PrimitiveSet& set,
    const primitives::ComposeOptions& options, bool outside, const std::string& provenance,
    const std::function<void(const primitives::Composition&)>& accept = {},
    const PartProgress& progress = {});

}  // namespace underbrush::regions
