/// \file
/// Reader of elevation maps in GeoTIFF.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "underbrush/io/raster_file.hpp"

namespace underbrush::io {

/// Reads the one band of a GeoTIFF with its place on the map: whole numbers or floats of 8 to 64
/// bits, in strips or tiles, without compression or with LZW, deflate or PackBits and a predictor.
/// Cells without a height are NaN and counted in `left_out`: those of the value that the file gives
/// for "no data", and those of −9999 or beyond ±32 766 m, which it does not name. `epsg` stays 0.
/// Throws `FormatError`, which names the command of GDAL that makes a file of this kind of one that
/// is compressed in another way, turned, of several bands or in degrees.
Raster read_geotiff(const std::filesystem::path& path, std::map<std::string, size_t>& left_out);

}  // namespace underbrush::io
