#include <fmt/format.h>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/io/raster_file.hpp"
#include "underbrush/metrics/canopy.hpp"
#include "underbrush/pipeline/world.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {
namespace rasters_verb {

struct Arguments {
  std::string model, output;
  metrics::CanopyOptions canopy;
  uint16_t epsg = 0;
};

void add_options(Verb& verb, Arguments& a) {
  CLI::App& app = verb.app;
  app.add_option("MODEL", a.model, "The folder of a model or scene, or a world of another program")
      ->required();
  verb.output("-o,--output", a.output, "The folder of maps (GeoTIFF) and voxels (NumPy)")
      ->required()
      ->type_name("FOLDER");
  app.add_option("--cell", a.canopy.cell_m, "Side of the cells and voxels, m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--rays", a.canopy.rays, "Number of rays along each side of a cell")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--cover-height", a.canopy.cover_height_m,
                 "Height above the ground from which plants count as cover, m")
      ->capture_default_str();
  app.add_option("--epsg", a.epsg, "Number of the maps' projected reference system; 0 = not known")
      ->check(CLI::Range(0, 32767))
      ->capture_default_str();
}

void check_folder(const fs::path& path) {
  io::check_output(path, io::OutputKind::kFolder);
  if (fs::exists(path) && !fs::is_regular_file(path / "rasters.json") && !fs::is_empty(path)) {
    throw IoError(path.string() +
                  ": cannot write: exists and is no folder of rasters; remove it or name another");
  }
}

/// Returns a map with its first row in the north.
io::Raster raster_of(const metrics::Canopy& c, const std::vector<float>& value, uint16_t epsg) {
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

/// Returns the mean of the values that are numbers.
double mean_of(const std::vector<float>& value) {
  double sum = 0;
  size_t n = 0;
  for (const float v : value) {
    if (!std::isfinite(v)) continue;
    sum += v;
    ++n;
  }
  return n ? sum / double(n) : NAN;
}

void run(const Verb& verb, const Arguments& a) {
  check_folder(a.output);
  const pipeline::World world = pipeline::read_world(a.model);
  metrics::Canopy c;
  try {
    const pipeline::TracedWorld traced(world.scene, world.info);
    c = metrics::canopy_of(world.scene, traced.still(), a.canopy);
  } catch (const DataError& e) {
    throw FormatError(a.model, "", e.what());
  }
  Json j{{"format", "underbrush-rasters"}, {"version", 1}};
  j["low_m"] = {c.low.x(), c.low.y(), c.low.z()};
  j["cell_m"] = c.cell_m;
  j["size"] = {c.size[0], c.size[1], c.size[2]};
  j["cover_height_m"] = a.canopy.cover_height_m;
  j["epsg"] = a.epsg;
  const size_t opaque = size_t(std::count(c.gap.begin(), c.gap.end(), 0.0F));
  j["opaque_voxels"] = opaque;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  j["mean_height_m"] = number(mean_of(c.height));
  j["mean_cover"] = number(mean_of(c.cover));
  j["mean_area_density_per_m"] = number(mean_of(c.area_density));
  j["provenance"] = io::json_of_text(provenance(verb, {a.model}));
  io::write_atomically(
      a.output,
      [&](const fs::path& folder) {
        make_temporary_folders(folder);
        io::write_geotiff(folder / "ground.tif", raster_of(c, c.ground, a.epsg));
        io::write_geotiff(folder / "canopy_height.tif", raster_of(c, c.height, a.epsg));
        io::write_geotiff(folder / "cover.tif", raster_of(c, c.cover, a.epsg));
        const std::vector<size_t> shape{c.size[2], c.size[1], c.size[0]};
        io::write_npy(folder / "gap_fraction.npy", shape, c.gap);
        io::write_npy(folder / "plant_area_density.npy", shape, c.area_density);
        write_file(folder / "rasters.json", io::text_of_json(j, 1) + "\n");
      },
      io::OutputKind::kFolder);
  const std::string canopy = std::isfinite(mean_of(c.cover))
                                 ? fmt::format("{:.2f} m high on average, cover {:.3f}",
                                               mean_of(c.height), mean_of(c.cover))
                                 : "unknown: there is no ground";
  verb.report(
      j, fmt::format("{} x {} cells of {:g} m, {} layers of voxels\n"
                     "  canopy      {}\n"
                     "  plants      {:.4f} m2/m3 on average, {} voxels that nothing passes\n"
                     "  rasters     {}\n",
                     c.size[0], c.size[1], c.cell_m, c.size[2], canopy, mean_of(c.area_density),
                     opaque, a.output));
}

}  // namespace rasters_verb
}  // namespace

void add_rasters(Program& program) {
  using namespace rasters_verb;
  auto a = std::make_shared<Arguments>();
  const auto verb =
      add_verb(program, "Models", "rasters",
               "Map canopy height and cover, and plant area density and gap fraction by voxel",
               "underbrush rasters model/ -o maps/\n"
               "  underbrush rasters forest.vox --cell 0.5 -o maps/",
               [a](const Verb& v) { run(v, *a); });
  add_options(*verb, *a);
}

}  // namespace underbrush::app
