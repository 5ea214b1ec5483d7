/// \file
/// The verb `movers`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>

#include <nlohmann/json.hpp>

#include "bind.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "watched.hpp"

namespace underbrush::python {
namespace {

std::pair<BeamLog, std::string> marked(const GivenLog& log, const movers::MoverOptions& options,
                                       const nb::object& progress) {
  std::pair<BeamLog, std::string> out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> source = source_of(log, true);
    BeamLog& whole = out.first;
    const pipeline::MoverMarks found = pipeline::mark_movers(
        *source, name_of(log), options,
        [&](const BeamLog& chunk, std::span<const uint8_t>) {
          if (whole.empty()) whole = chunk.like();
          whole.append(chunk, 0, chunk.size());
        },
        of_stage(hook, "movers"));
    whole.info = source->info();
    out.second = pipeline::json_of(found, nullptr, skipped_in(*source)).dump();
  });
  return out;
}

}  // namespace

void bind_movers(nb::module_& m) {
  bind_options(m, "MoverOptions", "movers", &movers::mover_options);
  m.def("movers", &marked, "log"_a, "options"_a, "progress"_a.none(),
        "Marks the returns of what moved during a log.");
}

}  // namespace underbrush::python
