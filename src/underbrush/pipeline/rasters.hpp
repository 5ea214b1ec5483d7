/// \file
/// The maps and voxels of the verb `rasters` on disk.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "underbrush/metrics/canopy.hpp"

namespace underbrush::pipeline {

/// Throws the `IoError` that `write_rasters` would end with.
void check_rasters_output(const std::filesystem::path& path);

/// Writes the folder `path`, atomically, replacing one of rasters that stood there: ground.tif,
/// canopy_height.tif and cover.tif with their first rows in the north, gap_fraction.npy and
/// plant_area_density.npy with the shape (layers, rows, columns), and rasters.json, whose text
/// (JSON) is returned. `epsg` is the number of the reference system, 0 if it is not known;
/// `provenance` is JSON. Throws `IoError`, also if another folder stands there.
std::string write_rasters(const std::filesystem::path& path, const metrics::Canopy& canopy,
                          double cover_height_m, uint16_t epsg, const std::string& provenance);

}  // namespace underbrush::pipeline
