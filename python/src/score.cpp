/// \file
/// The verb `score`.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "bind.hpp"
#include "given.hpp"
#include "option_table.hpp"
#include "prepared_world.hpp"
#include "report/report.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/score_json.inl"
#include "underbrush/pipeline/score_logs.hpp"
#include "watched.hpp"

namespace underbrush::python {
using namespace nb::literals;
namespace {

using metrics::Summary;

/// The scores of a simulation, and those of the baselines on the same beams.
struct ScoreValue : pipeline::LogScore {
  std::vector<pipeline::LogScore> baselines;
};

/// A log that is watched while it is read.
class WatchedLog : public WatchedSource {
 public:
  WatchedLog(std::unique_ptr<BeamSource> log, const Hook& hook)
      : WatchedSource(*log, hook, "score"), log_(std::move(log)) {}

 private:
  std::unique_ptr<BeamSource> log_;
};

/// The name of a log in errors; empty for one in memory.
std::string name_of_file(const GivenLog& log) {
  return std::holds_alternative<std::filesystem::path>(log) ? name_of(log) : "";
}

std::string clouds_compared(const GivenLog& real, const GivenLog& simulated,
                            const nb::object& progress) {
  std::string out;
  run_watched(progress, [&](const Hook& hook) {
    const auto a = source_of(real), b = source_of(simulated);
    try {
      out = pipeline::json_of_cloud_scores(pipeline::score_clouds(*a, *b, of_stage(hook, "score")))
                .dump();
    } catch (const DataError& e) {
      if (name_of_file(simulated).empty()) throw;
      throw FormatError(name_of_file(simulated), "", e.what());
    }
  });
  return out;
}

ScoreValue scored(const GivenLog& real, const GivenLog& simulated,
                  const std::optional<GivenWorld>& model, const std::optional<GivenLog>& train,
                  bool cloud, pipeline::ScoreOptions options, const nb::object& progress) {
  options.cloud = cloud;
  pipeline::Scores scores;
  run_watched(progress, [&](const Hook& hook) {
    const auto opened = [&hook](const GivenLog& log) -> metrics::OpenLog {
      return [&hook, &log] { return std::make_unique<WatchedLog>(source_of(log), hook); };
    };
    pipeline::SimulatedLog log{
        "", name_of_file(simulated), [&] { return source_of(simulated); }, {}};
    std::optional<PreparedWorld> world;
    if (model) {
      world.emplace(*model, SimulateOptions());
      log.world = [&] {
        return std::shared_ptr<const pipeline::TracedWorld>(&world->world(), [](auto) {});
      };
    }
    scores = pipeline::score_logs(
        {opened(real), train ? opened(*train) : metrics::OpenLog(), {std::move(log)}}, options);
  });
  return {std::move(scores.simulated.at(0)), std::move(scores.baselines)};
}

nlohmann::ordered_json json_of(const std::vector<std::string>& names,
                               const std::vector<ScoreValue>& values,
                               const std::string& provenance) {
  pipeline::Scores scores{{values.begin(), values.end()}, values.at(0).baselines};
  for (size_t k = 0; k < values.size(); ++k) scores.simulated[k].name = names[k];
  return pipeline::json_of_scores(scores, provenance);
}

/// A dict of the scores of a protocol; None where it was not asked for.
nb::object protocol_of(const ScoreValue& s, const char* name) {
  const nlohmann::ordered_json j = pipeline::json_of_log_score(s);
  if (!j.contains(name)) return nb::none();
  return nb::module_::import_("json").attr("loads")(j[name].dump());
}

}  // namespace

// long: a list of members.
void bind_score(nb::module_& m) {
  nb::class_<Summary>(
      m, "Summary",
      "The scores of a set of beams. A score that has no data or was not asked for is NaN.")
      .def_ro("beams", &Summary::beams, "Number of beams.")
      .def_ro("true_hits", &Summary::true_hits, "Beams that return in both logs.")
      .def_ro("false_hits", &Summary::false_hits, "Beams that return in the simulated log only.")
      .def_ro("false_misses", &Summary::false_misses, "Beams that return in the real log only.")
      .def_ro("true_misses", &Summary::true_misses, "Beams that return in neither log.")
      .def_ro("recall_of_misses", &Summary::recall_of_misses,
              "True misses / all real misses: the share of real misses reproduced.")
      .def_ro("precision_of_misses", &Summary::precision_of_misses,
              "True misses / all simulated misses: the share of them that are real.")
      .def_ro("f1_of_misses", &Summary::f1_of_misses,
              "2 true misses / (real misses + simulated misses).")
      .def_ro("informedness", &Summary::informedness,
              "Recall of hits + recall of misses - 1; 0 for a simulator that always hits.")
      .def_ro("precision", &Summary::precision, "True hits / all simulated hits.")
      .def_ro("recall", &Summary::recall, "True hits / all real hits.")
      .def_ro("f1", &Summary::f1, "F1 of hits: harmonic mean of precision and recall.")
      .def_ro("packet_error_m", &Summary::packet_error_m,
              "m; mean over packets of the mean error of true hits.")
      .def_ro("median_range_error_m", &Summary::median_range_error_m, "m; of true hits.")
      .def_ro("capped_error_m", &Summary::capped_error_m,
              "m; mean over all beams of the error, at most 2 m.")
      .def_ro("cloud_error_m", &Summary::cloud_error_m,
              "m; mean distance to the nearest point, both ways.")
      .def_ro("density_aware_chamfer", &Summary::density_aware_chamfer,
              "In [0, 1]; 0 where both clouds are alike in place and density.")
      .def_ro("nll_per_beam", &Summary::nll_per_beam,
              "Mean negative log-likelihood of the real outcome.")
      .def_ro("crps_m", &Summary::crps_m,
              "m; mean continuous ranked probability score of the range.")
      .def("__repr__", [](const Summary& s) {
        return nb::str(nb::str("Summary({} beams, capped error {:.3f} m, informedness {:.4f})")
                           .attr("format")(s.beams, s.capped_error_m, s.informedness));
      });
  bind_options<pipeline::ScoreOptions>(m, "ScoreOptions", "score",
                                       [] { return pipeline::score_options(); });
  using S = ScoreValue;
  nb::class_<S>(m, "Score", "The scores of a simulation.")
      .def_prop_ro(
          "all", [](const S& s) -> const auto& { return s.score.all; }, "Of all beams.")
      .def_prop_ro(
          "per_class", [](const S& s) -> const auto& { return s.score.per_class; },
          "By the real log's column `class`; reading this makes a dict.")
      .def_prop_ro(
          "per_range", [](const S& s) -> const auto& { return s.score.per_range; },
          "By real range; reading this makes a dict.")
      .def_prop_ro(
          "per_support", [](const S& s) -> const auto& { return s.score.per_support; },
          "By the share of a beam's outcome that rests on observed space: 'observed' (at least "
          "0.9), 'partly' and 'unknown' (below 0.5); empty for a model without a map of "
          "observed space. Reading this makes a dict.")
      .def_prop_ro(
          "calibration_error", [](const S& s) { return s.score.reliability.error(); },
          "Mean distance, over beams, of the predicted probability of a return from the share that "
          "returned, in bins of 5 %; NaN without a model.")
      .def_prop_ro(
          "calibration_bias", [](const S& s) { return s.score.reliability.bias(); },
          "Mean predicted probability of a return minus the share that returned.")
      .def_prop_ro(
          "roughness_m", [](const S& s) -> const auto& { return s.score.roughness_m; },
          "m; roughness along the rings of the simulated log.")
      .def_prop_ro(
          "real_roughness_m", [](const S& s) -> const auto& { return s.score.real_roughness_m; },
          "m; that of the real log.")
      .def_prop_ro(
          "baselines",
          [](const S& s) {
            std::map<std::string, S> out;
            for (const pipeline::LogScore& b : s.baselines) out[b.name] = {b, {}};
            return out;
          },
          "Scores of what a simulator must beat, by name.")
      .def_prop_ro(
          "kitti360", [](const S& s) { return protocol_of(s, "kitti360"); },
          nb::sig("def kitti360(self) -> dict[str, typing.Any] | None"),
          "Scores of range images, as learned simulators are scored; None without the option "
          "`protocol='kitti360'`.")
      .def_prop_ro(
          "repeats", [](const S& s) { return protocol_of(s, "repeats"); },
          nb::sig("def repeats(self) -> dict[str, typing.Any] | None"),
          "Comparison of the scans that were recorded from one place; None without the option "
          "`repeats`.")
      .def("__repr__", [](const S& s) {
        return nb::str(nb::str("Score({} beams, capped error {:.3f} m, informedness {:.4f})")
                           .attr("format")(s.score.all.beams, s.score.all.capped_error_m,
                                           s.score.all.informedness));
      });
  m.def("score", &scored, "real"_a, "simulated"_a, "model"_a.none(), "train"_a.none(), "cloud"_a,
        "options"_a, "progress"_a.none(),
        "Compares a simulated log with the real log of the same beams.");
  m.def("compare_clouds", &clouds_compared, "real"_a, "simulated"_a, "progress"_a.none(),
        "Compares two logs that share no beams as point clouds, and returns the scores as JSON.");
  m.def(
      "write_score_report",
      [](const std::filesystem::path& folder, const std::filesystem::path& real,
         const std::filesystem::path& simulated, const S& score, const std::string& provenance) {
        const std::string name = simulated.stem().string();
        return report::write_report(
            folder, report::page_of_scores(json_of({name}, {score}, provenance), real,
                                           {{name, simulated}}));
      },
      "folder"_a, "real"_a, "simulated"_a, "score"_a, "provenance"_a,
      nb::call_guard<nb::gil_scoped_release>(), "Writes the page of a score and returns its path.");
  m.def(
      "scores_json",
      [](const std::vector<std::string>& names, const std::vector<S>& scores,
         const std::string& provenance) { return json_of(names, scores, provenance).dump(); },
      "names"_a, "scores"_a, "provenance"_a,
      "Returns the scores as the JSON that `underbrush score --json` writes.");
}

}  // namespace underbrush::python
