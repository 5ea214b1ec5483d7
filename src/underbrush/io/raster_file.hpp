/// \file
/// Writers of rasters: GeoTIFF for maps, NumPy's NPY for grids of any dimension.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace underbrush::io {

/// A map of square cells. Row 0 is the northernmost, column 0 the westernmost; NaN = no value.
struct Raster {
  uint32_t columns = 0, rows = 0;
  std::vector<float> value;    ///< Row after row.
  double west = 0, north = 0;  ///< m; outer corner of the first cell.
  double cell_m = 1;           ///< m; side of a cell.
  uint16_t epsg = 0;           ///< Number of a projected reference system; 0 = not known.
  double unit_m = 1;           ///< m; length of the unit in which a file that was read is.
};

/// Writes a GeoTIFF, atomically: one band of 32-bit floats in one strip, without compression, with
/// the keys of GeoTIFF 1.1 (docs/reference/formats.md). Throws `IoError`, and
/// `std::invalid_argument` for a raster without cells or of 4 GiB and more.
void write_geotiff(const std::filesystem::path& path, const Raster& raster);

/// Writes an array of 32-bit floats in C order as NPY 1.0, atomically. Throws `IoError`, and
/// `std::invalid_argument` where the shape does not fit the values.
void write_npy(const std::filesystem::path& path, const std::vector<size_t>& shape,
               const std::vector<float>& value);

}  // namespace underbrush::io
