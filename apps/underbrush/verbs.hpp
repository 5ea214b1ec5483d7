/// All verbs of the command line, one `cmd_*.cpp` each.
#pragma once
#include "cli/completion.hpp"
#include "cli/config.hpp"
#include "cli/verb.hpp"

namespace underbrush::app {

inline constexpr const char* kSummary =
    "Underbrush: a lidar simulator learnt from logs of off-road terrain.";

void add_demo(Program& program);
void add_import(Program& program);
void add_info(Program& program);
void add_split(Program& program);
void add_fit(Program& program);
void add_optimize(Program& program);
void add_segment(Program& program);
void add_extract(Program& program);
void add_meshes(Program& program);
void add_annotate(Program& program);
void add_compose(Program& program);
void add_sensors(Program& program);
void add_simulate(Program& program);
void add_score(Program& program);

/// Adds all verbs, in the order of the stages.
inline void add_all_verbs(Program& program) {
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
  add_score(program);
  add_dump_config(program);
  add_completion(program);
}

}  // namespace underbrush::app
