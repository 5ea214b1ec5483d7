/// All verbs of the command line; each is in a file `cmd_*.cpp`.
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
void add_movers(Program& program);
void add_actors(Program& program);
void add_fit(Program& program);
void add_optimize(Program& program);
void add_segment(Program& program);
void add_extract(Program& program);
void add_meshes(Program& program);
void add_annotate(Program& program);
void add_primitives(Program& program);
void add_compose(Program& program);
void add_regions(Program& program);
void add_sensors(Program& program);
void add_simulate(Program& program);
void add_live(Program& program);
void add_perceive(Program& program);
void add_osi(Program& program);
void add_score(Program& program);
void add_rasters(Program& program);
void add_serve(Program& program);
void add_plan(Program& program);
void add_run(Program& program);
void add_merge(Program& program);

/// Adds all verbs, in the order of the stages.
void add_all_verbs(Program& program);

}  // namespace underbrush::app
