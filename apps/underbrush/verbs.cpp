#include "verbs.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "cli/dump_config.hpp"
#include "run.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::app {
namespace {

struct NamedVerb {
  std::string_view name;
  void (*add)(Program&);
};

// In the order of the stages.
constexpr NamedVerb kVerbs[] = {
    {"demo", add_demo},
    {"import", add_import},
    {"info", add_info},
    {"split", add_split},
    {"movers", add_movers},
    {"actors", add_actors},
    {"fit", add_fit},
    {"optimize", add_optimize},
    {"rasters", add_rasters},
    {"segment", add_segment},
    {"extract", add_extract},
    {"meshes", add_meshes},
    {"primitives", add_primitives},
    {"annotate", add_annotate},
    {"compose", add_compose},
    {"regions", add_regions},
    {"sensors", add_sensors},
    {"simulate", add_simulate},
    {"perceive", add_perceive},
    {"osi", add_osi},
    {"score", add_score},
    {"serve", add_serve},
    {"plan", add_plan},
    {"run", add_run},
    {"merge", add_merge},
    {"live", add_live},
};

}  // namespace

void add_all_verbs(Program& program) {
  program.app().require_subcommand(1);
  for (const NamedVerb& verb : kVerbs) verb.add(program);
  add_dump_config(program);
  const std::vector<std::string> sensors = sensor::names();
  add_completion(program, {{"sensor", sensors}, {"infer-misses", sensors}, {"deskew", sensors}});
}

int run_underbrush(int argc, char** argv) {
  Program program("underbrush", kSummary);
  // Making the options of all verbs takes longer than a short run of one.
  const auto* called =
      argc < 2 ? std::end(kVerbs) : std::ranges::find(kVerbs, argv[1], &NamedVerb::name);
  if (called == std::end(kVerbs)) {
    add_all_verbs(program);
  } else {
    program.app().require_subcommand(1);
    called->add(program);
  }
  return program.run(argc, argv);
}

}  // namespace underbrush::app
