#include <cmath>

#include "cli/line.hpp"
#include "cli/option_table.hpp"
#include "underbrush/io/json_text.inl"
#include "underbrush/rasters/rasters.hpp"
#include "verbs.hpp"

namespace underbrush::app {
namespace {
namespace rasters_verb {

struct Arguments {
  std::string model, output;
  rasters::RasterOptions options;
};

void run(const Verb& verb, const Arguments& a) {
  rasters::check_rasters_output(a.output);
  const rasters::Canopy c = rasters::canopy_of_world(a.model, a.options);
  const Json j =
      io::json_of_text(rasters::write_rasters(a.output, c, a.options, provenance(verb, {a.model})));
  const auto mean = [&](const char* name) {
    return j[name].is_null() ? NAN : j[name].get<double>();
  };
  const std::string canopy = std::isfinite(mean("mean_cover"))
                                 ? fmt::format("{:.2f} m high on average, cover {:.3f}",
                                               mean("mean_height_m"), mean("mean_cover"))
                                 : "unknown: there is no ground";
  verb.report(j, fmt::format("{} x {} cells of {:g} m, {} layers of voxels\n", c.size[0], c.size[1],
                             c.cell_m, c.size[2]) +
                     line("canopy", "{}", canopy) +
                     line("plants", "{:.4f} m2/m3 on average, {} voxels that nothing passes",
                          mean("mean_area_density_per_m"), j["opaque_voxels"].get<size_t>()) +
                     line("rasters", "{}", a.output));
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
  verb->app
      .add_option("MODEL", a->model,
                  "The folder of a model, scene or world of regions, or a world of another program")
      ->required();
  verb->output("-o,--output", a->output, "The folder of maps (GeoTIFF) and voxels (NumPy)")
      ->required()
      ->type_name("FOLDER");
  add_options(*verb, rasters::raster_options(), a->options);
}

}  // namespace underbrush::app
