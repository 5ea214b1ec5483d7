// This study is Table II of [tallavajhula18]: primitives cut from one site simulate another,
// compared with plant meshes, with a fit of the other site itself, and with replay.
#include "studies/primitives.hpp"

#include <fmt/format.h>

#include "studies/studies.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"
#include "underbrush/pipeline/plants.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr size_t kSitePairs = 10, kQuickSitePairs = 2;
constexpr uint64_t kMeshSeed = 777;  // No site is grown from this seed.
constexpr double kOtherSpecies = 2;  // Variation of the plants whose species differ from the
                                     // sites'.
constexpr const char* kTrueSpecies = "meshes (true species)";

std::string summary_of(const PairOutcome& o) {
  std::string text = o.name + ":";
  for (const std::string& row : o.rows) {
    const metrics::Summary& s = o.score.at(row).all;
    text +=
        fmt::format(" {} {:.2f} m {:.4f} {:.3f} m;", row, s.packet_error_m, s.f1, s.cloud_error_m);
  }
  return text;
}

void add_generated(const StudyRun& run, PairOptions options, StudyResult& result) {
  std::vector<PairOutcome> outcomes;
  const size_t pairs = run.quick ? kQuickSitePairs : kSitePairs;
  for (size_t k = 0; k < pairs; ++k) {
    const uint64_t first = 1000 * run.seed + 2 * k;
    options.pictures = k == 0;
    outcomes.push_back(run_pair(generated_pair(first, first + 1, run.quick), options));
    run.say(summary_of(outcomes.back()));
  }
  add_outcomes("generated sites", outcomes, true, result);
}

void add_drives(const StudyRun& run, PairOptions options, StudyResult& result) {
  options.meshes[0].name = "meshes";  // No drive leads through the generated plants.
  const std::vector<fs::path> logs = drives_of(run.data);
  if (logs.empty()) result.notes.push_back("real drives were left out: no --data folder of logs");
  for (const fs::path& log : logs) {
    const std::string name = log.parent_path().filename().string();
    const std::vector<StretchPair> pairs = pairs_of_drive(log);
    if (pairs.empty()) {
      result.notes.push_back(name + " was left out: no two stretches of it are 100 m apart");
      continue;
    }
    std::vector<PairOutcome> outcomes;
    for (const StretchPair& pair : pairs) {
      options.pictures = outcomes.empty();
      outcomes.push_back(run_pair(read_stretches(log, pair), options));
      run.say(summary_of(outcomes.back()));
    }
    add_outcomes(name, outcomes, false, result);
    result.inputs.push_back(log);
  }
}

}  // namespace

StudyResult study_primitives(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "Primitives cut from one site simulate another, against plant meshes composed along the same "
      "annotation (Table II of Tallavajhula et al. 2018).";
  const TemporaryPath temporary(fs::temp_directory_path(), "study");
  const fs::path folder = run.keep.empty() ? temporary.path() : run.keep;
  fs::create_directories(folder);
  PairOptions options;
  options.seed = run.seed;
  const auto add_meshes = [&](const char* name, const char* where,
                              const std::vector<plant_meshes::PlantSource>& plants) {
    options.meshes.push_back({name, folder / where});
    primitives::write_primitives(folder / where, plant_meshes::mesh_primitives(plants), 2, "");
  };
  add_meshes(kTrueSpecies, "meshes", pipeline::generated_plants(kMeshSeed));
  options.meshes.push_back({"meshes, not adapted", options.meshes[0].folder, false});
  add_meshes("meshes (other species)", "meshes-other",
             pipeline::generated_plants(kMeshSeed, kOtherSpecies));
  const fs::path files = run.data / "meshes";
  if (!run.data.empty() && fs::is_directory(files)) {
    add_meshes("meshes (files)", "meshes-files", pipeline::plants_of_files(files, {}));
    result.inputs.push_back(files);
  }
  add_generated(run, options, result);
  add_drives(run, options, result);
  result.notes.push_back(
      "True species: the generated sites' own, other individuals, a stronger baseline than the "
      "paper's, whose meshes were of other plants. The verdict is against these, adapted to the "
      "objects as primitives are.");
  return result;
}

}  // namespace underbrush::studies
