// This study holds simulated lists of objects against real ones, as [rosenberger20] section 4 does.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "studies/chain_lists.hpp"
#include "studies/sequential.hpp"
#include "studies/studies.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/perception/object_list_file.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/reports_json.inl"

namespace underbrush::studies {
namespace {
namespace fs = std::filesystem;

using perception::ObjectList;

constexpr double kElevationOffsetRad = 0.205 * M_PI / 180;  // KITTI: docs/how-to/kitti.md.
constexpr double kMinRangeM = 3;                            // The own car.
constexpr uint32_t kEveryNth = 3;  // Scan that the static world is fitted to.
/// Parameters of the strategy `tracking` that make the boxes as `real_lists` does.
const std::map<std::string, std::string> kTracking{
    {"as_measured", "true"}, {"min_range_m", "3"}, {"axle_height_m", "0"}};

/// A real log with its labels.
struct RealLog {
  std::string name;
  io::BeamReader beams;
  perception::LogTruth truth;
  std::vector<actors::Track> tracks;

  explicit RealLog(const fs::path& folder)
      : name(folder.filename().string()),
        beams(folder / "log.ply"),
        truth(folder / "objects.csv", beams.info(), {kElevationOffsetRad}),
        tracks(actors::tracks_of(truth.seen())) {}
};

/// The lists of the real scans.
perception::PerceivedLog real_lists(RealLog& log) {
  perception::PerceptionSetup setup = measured_setup(false);
  setup.cycles.min_range_m = kMinRangeM;
  return perception::perceived(log.beams, &log.truth, setup);
}

elements::Model static_world(const StudyRun& run, RealLog& log) {
  MarkedScans beams(log.beams, log.tracks, kEveryNth);
  fit::FitOptions options;
  options.seed = run.seed;
  options.min_range_m = kMinRangeM;
  return pipeline::fit_model({beams}, options).model;
}

/// Lists of the simulated drive with these models in place of the objects.
std::vector<ListCandidate> simulated_lists(const StudyRun& run, const RealLog& log,
                                           const elements::Model& world,
                                           std::vector<elements::Model> objects,
                                           const std::string& name) {
  run.say(log.name + ": " + name);
  ChainLists lists = chain_lists(log.beams.info(), log.truth,
                                 {world, log.tracks, std::move(objects)}, kTracking, run.seed);
  return {{name + "/model", std::move(lists.model)},
          {name + "/pipeline", std::move(lists.pipeline)}};
}

report::Table means_table(
    const std::string& log,
    const std::vector<std::pair<std::string, std::array<ValueComparison, 6>>>& rows) {
  report::Table table{log + ": RMSE against the real lists, m",
                      "Means over the objects of the root mean squared difference to the real "
                      "lists. Objects in fewer than 10 common cycles are left out.",
                      {"lists"},
                      {}};
  for (const char* value : perception::kComparedValues) table.head.emplace_back(value);
  std::vector<std::string> truth{"truth"};
  for (const ValueComparison& v : rows[0].second) truth.push_back(fmt::format("{:.3f}", v.truth_m));
  table.rows.push_back(truth);
  for (const auto& [name, values] : rows) {
    std::vector<std::string> cells{name};
    for (const ValueComparison& v : values) cells.push_back(fmt::format("{:.3f}", v.candidate_m));
    table.rows.push_back(cells);
  }
  return table;
}

/// Adds the tables and checks of a log's lists.
void compare(const StudyRun& run, const std::string& log, const perception::PerceivedLog& real,
             std::vector<ListCandidate> candidates, StudyResult& out) {
  candidates.push_back({"noisy truth", noisy_truth(real.truth, real.lists, run.seed)});
  std::vector<std::vector<perception::ComparedObject>> compared;
  std::vector<std::pair<std::string, std::array<ValueComparison, 6>>> means;
  std::vector<std::string> names{"real"};
  perception::ListScoreOptions open;  // Only what the camera sees is labelled.
  open.ignore_unmatched = true;
  std::vector<perception::ListScore> scores{perception::score_lists(real.lists, real.truth, open)};
  std::vector<report::NamedLists> shown{{"real", real.lists}};
  for (ListCandidate& c : candidates) {
    compared.push_back(perception::compare_lists(c.lists, real.lists, real.truth));
    means.emplace_back(c.name, value_comparison(compared.back()));
    names.push_back(c.name);
    scores.push_back(perception::score_lists(c.lists, real.truth, open));
    out.figures[log][c.name] = {{"against_truth", pipeline::json_of(scores.back())},
                                {"normalised_rmse", pipeline::json_of(compared.back())}};
    if (!run.keep.empty()) {
      std::string file = c.name + ".json";
      std::replace(file.begin(), file.end(), '/', '-');
      fs::create_directories(run.keep / log);
      perception::write_object_lists(run.keep / log / file, c.lists, "");
    }
  }
  out.figures[log]["real"] = pipeline::json_of(scores[0]);
  out.tables.push_back(means_table(log, means));
  out.tables.push_back(report::table_of("the labels of " + log, names, scores));
  for (size_t k = 0; k + 1 < candidates.size(); ++k) {
    out.tables.push_back(report::table_of(compared[k], candidates[k].name, "real"));
    for (const Check& c :
         list_checks(log + "/" + candidates[k].name, compared[k], compared.back())) {
      out.checks.push_back(c);
    }
    if (k < 2) shown.push_back({candidates[k].name, candidates[k].lists});
  }
  for (report::NamedLists& l : shown) {  // Only what is labelled can be drawn side by side.
    for (ObjectList& list : l.lists) {
      std::erase_if(list.objects, [](const auto& o) { return o.truth_id == 0; });
    }
  }
  out.pictures += report::list_pictures({"labels", real.truth}, shown);
}

void run_log(const StudyRun& run, const fs::path& folder, StudyResult& out) {
  RealLog log(folder);
  out.inputs.insert(out.inputs.end(), {folder / "log.ply", folder / "objects.csv"});
  run.say(log.name + ": real lists");
  const perception::PerceivedLog real = real_lists(log);
  run.say(log.name + ": static world");
  const elements::Model world = static_world(run, log);
  run.say(log.name + ": objects");
  std::vector<elements::Model> own = learnt_models(log.beams, log.tracks, run.seed);
  std::vector<ListCandidate> candidates =
      simulated_lists(run, log, world, meshes_of(log.tracks), "meshes");
  for (ListCandidate& c : simulated_lists(run, log, world, std::move(own), "ellipsoids")) {
    candidates.push_back(std::move(c));
  }
  compare(run, log.name, real, std::move(candidates), out);
}

}  // namespace

StudyResult study_sequential(const StudyRun& run) {
  StudyResult out;
  out.lead =
      "Lists of objects from simulated scans, against those that the same processing makes of real "
      "scans, and the intersection of [rosenberger20] Fig. 11.";
  run_intersection(run, out);
  bool has_log = false;
  if (!run.data.empty()) {
    std::vector<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(run.data)) {
      if (fs::exists(entry.path() / "log.ply") && fs::exists(entry.path() / "objects.csv")) {
        folders.push_back(entry.path());
      }
    }
    std::sort(folders.begin(), folders.end());
    for (const fs::path& folder : folders) run_log(run, folder, out);
    has_log = !folders.empty();
  }
  if (!has_log) {
    out.notes.push_back(
        "no real log: --data DIR names a folder of folders with log.ply and objects.csv");
  }
  return out;
}

}  // namespace underbrush::studies
