#include "cli/line.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/cut.hpp"
#include "underbrush/regions/world_writer.hpp"
#include "verbs.hpp"

namespace underbrush::app {

void add_regions(Program& program) {
  struct Arguments {
    std::string model, output;
    double side_m = 0;
  };
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "regions", "Cut a model or scene into regions on disk",
      "underbrush regions scene/ -o world/\n"
      "  underbrush simulate world/ --like log.ply --memory 2GiB -o sim.ply",
      [a](const Verb& v) {
        require(a->side_m == 0 || a->side_m >= 1, "regions: --side is 0, or 1 m or more");
        regions::check_world_output(a->output);
        const pipeline::World world = pipeline::read_world(a->model);
        const double side_m = a->side_m > 0 ? a->side_m : regions::side_by_elements(world.scene);
        const size_t n = regions::write_world(a->output, world.scene, world.info, side_m,
                                              provenance(v, {a->model}));
        v.report(Json{{"regions", n}, {"side_m", side_m}},
                 fmt::format("{} regions of {:g} m\n", n, side_m) + line("world", "{}", a->output));
      });
  verb->app.add_option("MODEL", a->model, "The folder of a model or scene")->required();
  verb->output("-o,--output", a->output, "The folder of the world")->required()->type_name("WORLD");
  verb->app
      .add_option("--side", a->side_m,
                  "Side of the regions, m; 0 = 16 to 1024, so that a region has at most 100 000 "
                  "elements on average")
      ->check(CLI::Range(0.0, 1e5))
      ->capture_default_str();
}

}  // namespace underbrush::app
