/// All verbs of the command line, one `cmd_*.cpp` each.
#pragma once
#include <CLI/CLI.hpp>

namespace underbrush::app {

void remember_command_line(int argc, char** argv);

void add_demo(CLI::App& root);
void add_import(CLI::App& root);
void add_info(CLI::App& root);
void add_fit(CLI::App& root);
void add_simulate(CLI::App& root);
void add_score(CLI::App& root);
void add_optimize(CLI::App& root);
void add_segment(CLI::App& root);
void add_extract(CLI::App& root);
void add_meshes(CLI::App& root);
void add_annotate(CLI::App& root);
void add_compose(CLI::App& root);
void add_sensors(CLI::App& root);
void add_split(CLI::App& root);
void add_study(CLI::App& root);

inline void add_all_verbs(CLI::App& root) {
  add_demo(root);
  add_import(root);
  add_info(root);
  add_split(root);
  add_segment(root);
  add_fit(root);
  add_optimize(root);
  add_extract(root);
  add_meshes(root);
  add_annotate(root);
  add_compose(root);
  add_simulate(root);
  add_score(root);
  add_sensors(root);
  add_study(root);
}

}  // namespace underbrush::app
