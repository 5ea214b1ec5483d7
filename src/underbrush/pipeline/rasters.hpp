/// \file
/// The verb `rasters`: a model or scene in, maps and voxels out, also on disk.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "underbrush/core/option.hpp"
#include "underbrush/metrics/canopy.hpp"

namespace underbrush::pipeline {

/// The options of `rasters`.
struct RasterOptions {
  metrics::CanopyOptions canopy;
  unsigned epsg = 0;  ///< Number of the maps' reference system; 0 = not known.
};

/// The options of `rasters`.
std::span<const Option<RasterOptions>> raster_options();

/// Reads a model, a scene or a world of another program, and computes its cells and voxels. Throws
/// `FormatError`, and `std::invalid_argument` for options out of range.
metrics::Canopy canopy_of_world(const std::filesystem::path& path, const RasterOptions& options);

/// Throws the `IoError` that `write_rasters` would end with.
void check_rasters_output(const std::filesystem::path& path);

/// Writes the folder `path`, atomically, replacing one of rasters that stood there: ground.tif,
/// canopy_height.tif and cover.tif with their first rows in the north, gap_fraction.npy and
/// plant_area_density.npy with the shape (layers, rows, columns), and rasters.json, whose text
/// (JSON) is returned. `provenance` is JSON. Throws `IoError`, also if another folder stands there.
std::string write_rasters(const std::filesystem::path& path, const metrics::Canopy& canopy,
                          const RasterOptions& options, const std::string& provenance);

}  // namespace underbrush::pipeline
