#include <algorithm>

#include "studies/mesh_fidelity.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/metrics/leaf_cloud.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

/// Returns the point files of a folder, and the logs of its folders: log.ply, or else train.ply.
std::vector<fs::path> clouds_of(const fs::path& folder) {
  std::vector<fs::path> files;
  if (folder.empty()) return files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    for (const char* name : {"log.ply", "train.ply"}) {
      if (!fs::exists(entry.path() / name)) continue;
      files.push_back(entry.path() / name);
      break;
    }
    if (entry.is_regular_file() && io::is_table_file(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

void add_real_vegetation(const StudyRun& run, StudyResult& result) {
  report::Table table{
      "Real clouds",
      "Vegetation of logs: trees and shrubs by the labels of the log, or else what is "
      "not ground (as `fit` tells it), 3 to 25 m from the sensor; first: of the first "
      "scan alone. Point files: all points.",
      {"cloud", "told by", "points", "μ", "σ", "ε", "criterion", "gap"},
      {}};
  for (const fs::path& file : clouds_of(run.data)) {
    const bool log = file.filename() == "train.ply" || file.filename() == "log.ply";
    const std::string name = log ? file.parent_path().filename().string() : file.stem().string();
    run.say("leaves of " + name);
    const metrics::LeafCloud cloud = metrics::leaf_cloud(file);
    if (cloud.points.size() < 30) {
      result.notes.push_back(name + " was left out: fewer than 30 points");
      continue;
    }
    result.inputs.push_back(file);
    const auto add = [&](const std::string& what, const std::vector<Vec3f>& points) {
      const metrics::LeafInclination leaves = metrics::leaf_inclination(points);
      std::vector<std::string> row{what, cloud.by};
      for (std::string& cell : cells(leaves)) row.push_back(std::move(cell));
      table.rows.push_back(std::move(row));
      result.figures["real"][what] = json_of(leaves);
    };
    add(name, cloud.points);
    if (cloud.first_scan >= 30 && cloud.first_scan < cloud.points.size()) {
      add(name + ", first scan",
          {cloud.points.begin(), cloud.points.begin() + std::ptrdiff_t(cloud.first_scan)});
    }
  }
  if (table.rows.empty()) {
    result.notes.emplace_back(
        "real vegetation was left out: no --data folder with point files or logs");
  } else {
    result.tables.push_back(table);
  }
}

}  // namespace underbrush::studies
