/// \file
/// The verb `movers`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bind.hpp"
#include "given.hpp"
#include "underbrush/movers/find_movers.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using movers::MoverOptions;

std::pair<BeamLog, std::string> marked(const GivenLog& log, const MoverOptions& options,
                                       const nb::object& progress) {
  std::pair<BeamLog, std::string> out;
  run_watched(progress, [&](const Hook& hook) {
    options.check();
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    movers::require_two_scans(*source, name_of(log));
    const std::vector<uint8_t> is_mover = movers::find_movers(
        *source, options, [&](size_t done, size_t total) { hook("movers", done, total); });
    BeamLog& whole = out.first;
    size_t returns = 0;
    source->rewind();
    for (BeamLog chunk; source->next(chunk);) {
      if (whole.empty()) {
        whole = chunk.like();
        whole.reserve(source->size());
      }
      movers::mark_movers(is_mover, whole.size(), chunk);
      for (size_t i = 0; i < chunk.size(); ++i) returns += chunk.is_hit(i);
      whole.append(chunk, 0, chunk.size());
    }
    whole.info = source->info();
    out.second = nlohmann::ordered_json{{"rows", whole.size()},
                                        {"returns", returns},
                                        {"marked", std::ranges::count(is_mover, 1)},
                                        {"skipped", skipped_in(*source)}}
                     .dump();
  });
  return out;
}

}  // namespace

void bind_movers(nb::module_& m) {
  using O = MoverOptions;
  nb::class_<O>(m, "MoverOptions", "The options of `movers`.")
      .def(nb::init<>())
      .def_rw("look_s", &O::look_s)
      .def_rw("least_empty", &O::least_empty)
      .def_rw("cell_deg", &O::cell_deg)
      .def_rw("max_range", &O::max_range_m)
      .def_rw("same_m", &O::same_m)
      .def_rw("least_points", &O::least_points);
  m.def("movers", &marked, "log"_a, "options"_a, "progress"_a.none(),
        "Marks the returns of what moved during a log.");
}

}  // namespace underbrush::python
