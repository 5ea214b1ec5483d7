/// \file
/// The verb `rasters`: a model or scene in, maps and voxels out, also on disk.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/rasters/canopy.hpp"
#include "underbrush/regions/open_regions.hpp"

namespace underbrush::rasters {

/// The options of `rasters`.
struct RasterOptions {
  CanopyOptions canopy;
  unsigned epsg = 0;                      ///< Number of the maps' reference system; 0 = not known.
  std::string memory = regions::kMemory;  ///< For a world of regions (`regions::memory_of`).
};

/// The options of `rasters`.
std::span<const Option<RasterOptions>> raster_options();

/// Reads a model, a scene or a world of another program, and computes its cells and voxels. Of a
/// world of regions, no more are open at a time than fit into the memory of the options. Throws
/// `FormatError`, and `std::invalid_argument` for options out of range.
Canopy canopy_of_world(const std::filesystem::path& path, const RasterOptions& options);

/// Throws the `IoError` that `write_rasters` would end with.
void check_rasters_output(const std::filesystem::path& path);

/// Writes the folder `path`, atomically, replacing one of rasters that stood there: ground.tif,
/// canopy_height.tif and cover.tif with their first rows in the north, gap_fraction.npy and
/// plant_area_density.npy with the shape (layers, rows, columns), and rasters.json, whose text
/// (JSON) is returned. `provenance` is JSON. Throws `IoError`, also if another folder stands there.
std::string write_rasters(const std::filesystem::path& path, const Canopy& canopy,
                          const RasterOptions& options, const std::string& provenance);

}  // namespace underbrush::rasters
