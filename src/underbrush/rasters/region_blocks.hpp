/// \file
/// The stand of a world of regions, computed in blocks of which the regions fit into memory. This
/// file is internal to the module.
#pragma once
#include "underbrush/rasters/canopy.hpp"
#include "underbrush/regions/world_folder.hpp"

namespace underbrush::rasters {

/// Computes the result of `canopy_of` for the whole world, to the bit. No more regions are open at
/// a time than fit into `memory_bytes`, their common part included; the stand itself takes memory
/// besides. Throws as `CanopyMaker` does, `FormatError` for a damaged region, and `DataError` where
/// the regions of one column of cells do not fit.
Canopy canopy_of_regions(const regions::WorldFolder& world, uint64_t memory_bytes,
                         const CanopyOptions& options);

}  // namespace underbrush::rasters
