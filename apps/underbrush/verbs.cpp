#include "verbs.hpp"

#include "run.hpp"

namespace underbrush::app {

void add_all_verbs(Program& program) {
  program.app().require_subcommand(1);
  add_demo(program);
  add_import(program);
  add_info(program);
  add_split(program);
  add_fit(program);
  add_optimize(program);
  add_segment(program);
  add_extract(program);
  add_meshes(program);
  add_annotate(program);
  add_compose(program);
  add_sensors(program);
  add_simulate(program);
  add_perceive(program);
  add_score(program);
  add_dump_config(program);
  add_completion(program);
}

int run_underbrush(int argc, char** argv) {
  Program program("underbrush", kSummary);
  add_all_verbs(program);
  return program.run(argc, argv);
}

}  // namespace underbrush::app
