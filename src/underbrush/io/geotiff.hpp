/// \file
/// Reader of elevation maps in GeoTIFF.
#pragma once
#include <filesystem>

#include "underbrush/io/raster_file.hpp"

namespace underbrush::io {

/// Reads the one band of a GeoTIFF with its place on the map: whole numbers or floats of 8 to 64
/// bits, in strips or tiles, without compression or with LZW, deflate or PackBits and a predictor.
/// Cells with the value that the file gives for "no data" are NaN. `epsg` stays 0. Throws
/// `FormatError`, which names the command of GDAL that makes a file of this kind of one that is
/// compressed in another way, turned or of several bands.
Raster read_geotiff(const std::filesystem::path& path);

}  // namespace underbrush::io
