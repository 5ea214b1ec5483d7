#include "underbrush/rasters/rasters.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/raster_file.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/rasters/region_blocks.hpp"

namespace underbrush::rasters {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Returns a map with its first row in the north.
io::Raster raster_of(const Canopy& c, const std::vector<float>& value, uint16_t epsg) {
  io::Raster r;
  r.columns = c.size[0];
  r.rows = c.size[1];
  r.cell_m = c.cell_m;
  r.west = c.low.x();
  r.north = c.low.y() + c.cell_m * c.size[1];
  r.epsg = epsg;
  for (size_t row = c.size[1]; row-- > 0;) {
    const auto first = value.begin() + std::ptrdiff_t(row * c.size[0]);
    r.value.insert(r.value.end(), first, first + c.size[0]);
  }
  return r;
}

/// Returns the mean of the values that are numbers; null where there is none.
Json mean_of(const std::vector<float>& value) {
  double sum = 0;
  size_t n = 0;
  for (const float v : value) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++n;
  }
  return io::finite_or_null(sum / double(n));
}

}  // namespace

std::span<const Option<RasterOptions>> raster_options() {
  using O = RasterOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"cell", "", "m", "Side of the cells and voxels",
     [](O& o) -> auto& { return o.canopy.cell_m; }, 0.01, 1000},
    {"rays", "", "", "Number of rays along each side of a cell",
     [](O& o) -> auto& { return o.canopy.rays; }, 1, 100},
    {"cover-height", "", "m", "Height above the ground from which plants count as cover",
     [](O& o) -> auto& { return o.canopy.cover_height_m; }, 0, 100},
    {"epsg", "", "", "EPSG number of the projected reference system of the maps; 0 = not known",
     [](O& o) -> auto& { return o.epsg; }, 0, 32767},
    {"memory", "", "", regions::kMemoryHelp,
     [](O& o) -> auto& { return o.memory; }, -kNoLimit, kNoLimit, {}, "SIZE"},
  };
// clang-format on
return kOptions;
}

Canopy canopy_of_world(const fs::path& path, const RasterOptions& options) {
  check_options("rasters", raster_options(), options);
  const uint64_t memory = regions::memory_of(options.memory);
  const pipeline::World world = pipeline::open_world(path);
  try {
    if (world.regions) return canopy_of_regions(*world.regions, memory, options.canopy);
    return canopy_of(world.scene, pipeline::TracedWorld(world.scene, world.info).still(),
                     options.canopy);
  } catch (const DataError& e) {
    throw FormatError(path.string(), "", e.what());
  }
}

void check_rasters_output(const fs::path& path) {
  io::check_output_folder(path, fs::is_regular_file(path / "rasters.json"), "no folder of rasters");
}

std::string write_rasters(const fs::path& path, const Canopy& c, const RasterOptions& options,
                          const std::string& provenance) {
  check_rasters_output(path);
  Json j{{"format", "underbrush-rasters"}, {"version", 1}};
  j["low_m"] = {c.low.x(), c.low.y(), c.low.z()};
  j["cell_m"] = c.cell_m;
  j["size"] = {c.size[0], c.size[1], c.size[2]};
  j["cover_height_m"] = options.canopy.cover_height_m;
  j["epsg"] = options.epsg;
  j["opaque_voxels"] = size_t(std::count(c.gap.begin(), c.gap.end(), 0.0F));
  j["mean_height_m"] = mean_of(c.height);
  j["mean_cover"] = mean_of(c.cover);
  j["mean_area_density_per_m"] = mean_of(c.area_density);
  j["provenance"] = io::json_of_text(provenance);
  std::string text = io::text_of_json(j, 1) + "\n";
  io::write_atomically(
      path,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        const auto epsg = uint16_t(options.epsg);
        io::write_geotiff(folder / "ground.tif", raster_of(c, c.ground, epsg));
        io::write_geotiff(folder / "canopy_height.tif", raster_of(c, c.height, epsg));
        io::write_geotiff(folder / "cover.tif", raster_of(c, c.cover, epsg));
        const std::vector<size_t> shape{c.size[2], c.size[1], c.size[0]};
        io::write_npy(folder / "gap_fraction.npy", shape, c.gap);
        io::write_npy(folder / "plant_area_density.npy", shape, c.area_density);
        write_file(folder / "rasters.json", text);
      },
      io::OutputKind::kFolder);
  return text;
}

}  // namespace underbrush::rasters
