/// \file
/// The verb `actors`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <nlohmann/json.hpp>

#include "bind.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "underbrush/pipeline/learn_actors.hpp"
#include "underbrush/pipeline/reports_json.inl"
#include "watched.hpp"

namespace underbrush::python {
namespace {

/// Learns the actors of a log, writes them, and returns the log with their returns marked and the
/// report.
std::pair<BeamLog, std::string> learnt(const GivenLog& log,
                                       const std::optional<std::filesystem::path>& boxes,
                                       const std::filesystem::path& output,
                                       const actors::ActorOptions& options, uint64_t seed,
                                       const std::string& provenance, const nb::object& progress) {
  std::pair<BeamLog, std::string> out;
  run_watched(progress, [&](const Hook& hook) {
    const std::unique_ptr<BeamSource> beams = source_of(log), rows = source_of(log, true);
    const std::string name = name_of(log);
    const auto tracks = actors::tracks_of_log(*beams, name, boxes.value_or(""), options);
    const actors::LearntActors found =
        pipeline::learn_actors(*beams, name, tracks, options, seed, of_stage(hook, "actors"));
    actors::BoxesOfBeams marks(tracks, options.boxes);
    BeamLog& whole = out.first;
    for (BeamLog chunk; rows->next(chunk);) {
      actors::mark_returns(marks, chunk);
      if (whole.empty()) whole = chunk.like();
      whole.append(chunk, 0, chunk.size());
    }
    whole.info = rows->info();
    actors::write_actors(output, found.actors, provenance);
    out.second = pipeline::json_of(found).dump();
  });
  return out;
}

}  // namespace

void bind_actors(nb::module_& m) {
  bind_options(m, "ActorOptions", "actors", &actors::actor_options);
  m.def("actors", &learnt, "log"_a, "boxes"_a.none(), "output"_a, "options"_a, "seed"_a,
        "provenance"_a, "progress"_a.none(),
        "Learns what moved during a log, as models with trajectories.");
}

}  // namespace underbrush::python
