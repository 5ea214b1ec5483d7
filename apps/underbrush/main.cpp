#include "cli/config.hpp"
#include "verbs.hpp"

int main(int argc, char** argv) {
  using namespace underbrush;
  app::Program program("underbrush",
                       "Underbrush: a lidar simulator learnt from logs of off-road terrain.");
  program.app().require_subcommand(1);
  app::add_all_verbs(program);
  app::add_dump_config(program);
  return program.run(argc, argv);
}
