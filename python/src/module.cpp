/// \file
/// The module `underbrush._core`.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdlib>

#include "bind.hpp"
#include "cli/outputs.hpp"
#include "cli/program.hpp"
#include "underbrush/core/parallel.hpp"

NB_MODULE(_core, m) {
  using namespace underbrush::python;
  m.doc() = "The C++ library of Underbrush; `underbrush` has its public names.";
  // A user's annotation such as Optional[Model] outlives the module in a cache of Python's; that is
  // no reason to warn at exit.
  nanobind::set_leak_warnings(std::getenv("UNDERBRUSH_LEAK_WARNINGS") != nullptr);
  bind_errors(m);
  bind_poses(m);
  bind_log_info(m);
  bind_log(m);
  bind_log_files(m);
  bind_model(m);
  bind_scene(m);
  bind_sensor(m);
  bind_fit(m);
  bind_score(m);
  bind_simulate(m);
  bind_lidar(m);
  bind_objects(m);
  bind_movers(m);
  bind_actors(m);
  bind_log_verbs(m);
  bind_optimize(m);
  bind_place(m);
  using namespace nanobind::literals;
  m.def("set_threads", &underbrush::set_threads, "threads"_a,
        "Limits the number of threads that this process uses from now on; 0 removes the limit.");
  m.def(
      "check_outputs",
      [](const std::vector<std::pair<std::string, std::string>>& outputs,
         const std::vector<std::string>& inputs, bool force) {
        std::vector<underbrush::app::Output> out;
        for (const auto& [option, path] : outputs) out.push_back({option, path, {}});
        underbrush::app::check_outputs(out, {inputs.begin(), inputs.end()}, force);
      },
      "outputs"_a, "inputs"_a, "force"_a,
      "Raises `OSError` where an output, an (option, path), would replace a file that Underbrush "
      "did\n"
      "not write, unless `force`, and `ValueError` where it would replace an input.");
  m.def("version", &underbrush::app::version, "Returns the version, such as \"0.1.0\".");
  m.def("threads", &underbrush::threads, "Returns the number of threads in use.");
}
