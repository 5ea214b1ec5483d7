#include "cli/line.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/regions/cut.hpp"
#include "underbrush/regions/world_writer.hpp"
#include "verbs.hpp"

namespace underbrush::app {

void add_regions(Program& program) {
  struct Arguments {
    std::string model, output;
    double side_m = regions::kSideM;
  };
  auto a = std::make_shared<Arguments>();
  const auto verb = add_verb(
      program, "Scenes", "regions", "Cut a model or scene into regions on disk",
      "underbrush regions scene/ -o world/\n"
      "  underbrush simulate world/ --like log.ply --memory 2GiB -o sim.ply",
      [a](const Verb& v) {
        regions::check_world_output(a->output);
        const pipeline::World world = pipeline::read_world(a->model);
        const size_t n = regions::write_world(a->output, world.scene, world.info, a->side_m,
                                              provenance(v, {a->model}));
        v.report(Json{{"regions", n}}, fmt::format("{} regions of {:g} m\n", n, a->side_m) +
                                           line("world", "{}", a->output));
      });
  verb->app.add_option("MODEL", a->model, "The folder of a model or scene")->required();
  verb->output("-o,--output", a->output, "The folder of the world")->required()->type_name("WORLD");
  verb->app.add_option("--side", a->side_m, "Side of the regions, m")
      ->check(CLI::Range(1.0, 1e5))
      ->capture_default_str();
}

}  // namespace underbrush::app
