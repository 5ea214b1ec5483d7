/// \file
/// The parts of the module `underbrush._core`; each function binds one part.
#pragma once
#include <nanobind/nanobind.h>

namespace underbrush::python {

void bind_errors(nanobind::module_& m);
void bind_poses(nanobind::module_& m);
void bind_log_info(nanobind::module_& m);
void bind_log(nanobind::module_& m);
void bind_log_files(nanobind::module_& m);
void bind_model(nanobind::module_& m);
void bind_scene(nanobind::module_& m);
void bind_sensor(nanobind::module_& m);
void bind_fit(nanobind::module_& m);
void bind_score(nanobind::module_& m);
void bind_simulate(nanobind::module_& m);
void bind_lidar(nanobind::module_& m);
void bind_objects(nanobind::module_& m);
void bind_actors(nanobind::module_& m);
void bind_movers(nanobind::module_& m);
void bind_log_verbs(nanobind::module_& m);
void bind_optimize(nanobind::module_& m);
void bind_place(nanobind::module_& m);

}  // namespace underbrush::python
