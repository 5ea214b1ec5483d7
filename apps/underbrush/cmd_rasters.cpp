#include <fmt/format.h>

#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/pipeline/rasters.hpp"
#include "underbrush/pipeline/world.hpp"
#include "verbs.hpp"

namespace underbrush::app {
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

void run(const Verb& verb, const Arguments& a) {
  pipeline::check_rasters_output(a.output);
  const pipeline::World world = pipeline::read_world(a.model);
  metrics::Canopy c;
  try {
    const pipeline::TracedWorld traced(world.scene, world.info);
    c = metrics::canopy_of(world.scene, traced.still(), a.canopy);
  } catch (const DataError& e) {
    throw FormatError(a.model, "", e.what());
  }
  const Json j = io::json_of_text(pipeline::write_rasters(a.output, c, a.canopy.cover_height_m,
                                                          a.epsg, provenance(verb, {a.model})));
  const auto mean = [&](const char* name) {
    return j[name].is_null() ? NAN : j[name].get<double>();
  };
  const std::string canopy = std::isfinite(mean("mean_cover"))
                                 ? fmt::format("{:.2f} m high on average, cover {:.3f}",
                                               mean("mean_height_m"), mean("mean_cover"))
                                 : "unknown: there is no ground";
  verb.report(
      j, fmt::format("{} x {} cells of {:g} m, {} layers of voxels\n"
                     "  canopy      {}\n"
                     "  plants      {:.4f} m2/m3 on average, {} voxels that nothing passes\n"
                     "  rasters     {}\n",
                     c.size[0], c.size[1], c.cell_m, c.size[2], canopy,
                     mean("mean_area_density_per_m"), j["opaque_voxels"].get<size_t>(), a.output));
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
