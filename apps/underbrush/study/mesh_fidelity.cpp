#include "study/mesh_fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/studies.hpp"
#include "svg_plot.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/fit/ground_flags.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

using metrics::LeafInclination;
constexpr double kVolumeM3 = 45;
constexpr size_t kFlatPlants = 2;  // billboard and cartoon come first

Json json_of(const LeafInclination& l) {
  return {{"points", l.points},
          {"mean_rad", l.mean_rad},
          {"sigma_rad", l.sigma_rad},
          {"epsilon", l.epsilon()},
          {"realistic", l.is_realistic()}};
}

std::vector<std::string> cells(const LeafInclination& l) {
  return {fmt::format("{}", l.points), fmt::format("{:.3f}", l.mean_rad),
          fmt::format("{:.3f}", l.sigma_rad), fmt::format("{:.3f}", l.epsilon()),
          l.is_realistic() ? "inside" : "outside"};
}

StudyTable sweep_table(const std::vector<PlantFigures>& plants) {
  StudyTable table{"Plants in a box of 45 m³, two OS1-64 on an approaching vehicle",
                   "μ, σ: of arccos n_z, rad; ε from (1.65, 0.747), inside: ε ≤ 0.11. Memory: of "
                   "vertices and triangles, or of the ellipsoids.",
                   {"plant", "elements", "per m³", "kB", "points", "μ", "σ", "ε", "criterion",
                    "elements ≥ 5/8 samples"},
                   {}};
  for (const PlantFigures& p : plants) {
    std::vector<std::string> row{p.name, fmt::format("{}", p.elements),
                                 fmt::format("{:.0f}", double(p.elements) / kVolumeM3),
                                 fmt::format("{:.0f}", double(p.bytes) / 1e3)};
    for (std::string& cell : cells(p.leaves)) row.push_back(std::move(cell));
    row.emplace_back(8 * p.elements >= 5 * p.leaves.points ? "yes" : "no");
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The least count of a plant inside the criterion, infinite if there is none.
double least_inside(const std::vector<PlantFigures>& plants) {
  double least = INFINITY;
  for (size_t k = kFlatPlants; k < plants.size(); ++k) {
    if (plants[k].leaves.is_realistic()) least = std::min(least, double(plants[k].elements));
  }
  return least;
}

StudyTable line_table(const std::vector<PlantFigures>& plants, const metrics::LogRegression& line) {
  const auto density = [](double n) {
    return std::isfinite(n) ? fmt::format("{:.0f}", n / kVolumeM3) : "none";
  };
  return {"ε = a − b ln n",
          "Minimum: the coarsest plant inside the criterion; recommended: where the line is at "
          "0.11. Triangles per m³.",
          {"", "a", "b", "R²", "minimum", "recommended"},
          {{"ours", fmt::format("{:.3f}", line.a), fmt::format("{:.4f}", line.b),
            fmt::format("{:.3f}", line.r2), density(least_inside(plants)),
            density(line.count_at(LeafInclination::kLargest))},
           {"published", "0.269", "0.0121", "0.635", "1600", "11000"}}};
}

std::string picture(const std::vector<PlantFigures>& plants, const metrics::LogRegression& line) {
  SvgPlot plot("Realism distance against the number of triangles", "log10 triangles", "ε, rad");
  SvgPlot::Points points;
  double most = 0.2;
  for (const PlantFigures& p : plants) {
    points.emplace_back(std::log10(double(p.elements)), p.leaves.epsilon());
    most = std::max(most, p.leaves.epsilon());
  }
  plot.x_axis(0, 7);
  plot.y_axis(0, 1.1 * most);
  plot.dots(points, "#27c", 6);
  const auto at = [&](double x) { return std::pair{x, line.a - line.b * x * M_LN10}; };
  plot.line({at(0), at(7)}, "#333");
  plot.line({{0, LeafInclination::kLargest}, {7, LeafInclination::kLargest}}, "#c33", true);
  return plot.svg();
}

/// Points that are not ground, within 25 m of their sensor.
std::vector<Vec3f> vegetation_of(const fs::path& file) {
  constexpr double kFarM = 25, kNearM = 3;
  io::LogReader log(file);
  const std::vector<uint8_t> ground = fit::ground_flags(log, {});
  std::vector<Vec3f> out;
  BeamLog chunk;
  log.rewind();
  size_t hit = 0;
  Vec3 origin = Vec3::Zero();
  while (log.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i)) continue;
      if (hit == 0) origin = chunk.origin[i];
      if (ground[hit++] || chunk.range_m[i] > kFarM || chunk.range_m[i] < kNearM) continue;
      out.push_back((chunk.end_point(i) - origin).cast<float>());
    }
  }
  return out;
}

std::vector<Vec3f> cloud_of(const fs::path& file) {
  const io::Table table = io::read_table(file);
  std::vector<Vec3> points(table.size());
  for (int axis = 0; axis < 3; ++axis) {
    const ExtraColumn* column = table.find({std::string(1, char('x' + axis))});
    if (!column) throw FormatError(file.string(), "", "no column x, y or z");
    const std::vector<double> values = io::doubles_of(*column);
    for (size_t i = 0; i < points.size(); ++i) points[i][axis] = values[i];
  }
  std::erase_if(points, [](const Vec3& p) { return !p.allFinite(); });
  std::vector<Vec3f> out;
  out.reserve(points.size());
  for (const Vec3& p : points) out.push_back((p - points[0]).cast<float>());
  return out;
}

}  // namespace

std::vector<Check> sweep_checks(const std::vector<PlantFigures>& plants,
                                const metrics::LogRegression& line) {
  std::vector<Check> out;
  for (size_t k = 0; k < kFlatPlants; ++k) {
    out.push_back({plants.at(k).name + " lies outside, ε", plants[k].leaves.epsilon(),
                   LeafInclination::kLargest, false});
  }
  const auto finest = std::max_element(
      plants.begin(), plants.end(),
      [](const PlantFigures& a, const PlantFigures& b) { return a.elements < b.elements; });
  out.push_back(
      {"the finest plant lies inside, ε", finest->leaves.epsilon(), LeafInclination::kLargest});
  out.push_back({"ε falls with ln n, b", line.b, 0.001, false});
  return out;
}

void add_real_vegetation(const StudyRun& run, StudyResult& result) {
  StudyTable table{"Real clouds",
                   "Vegetation of logs: points that are not ground (as `fit` tells it), 3 to 25 m "
                   "from the sensor, all scans of train.ply registered. Point files: all points.",
                   {"cloud", "points", "μ", "σ", "ε", "criterion"},
                   {}};
  std::vector<fs::path> files;
  if (!run.data.empty()) {
    for (const auto& entry : fs::directory_iterator(run.data)) {
      if (fs::exists(entry.path() / "train.ply")) files.push_back(entry.path() / "train.ply");
      if (entry.is_regular_file() && io::is_table_file(entry.path())) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const bool log = file.filename() == "train.ply";
    const std::string name = log ? file.parent_path().filename().string() : file.stem().string();
    run.say("leaves of " + name);
    const std::vector<Vec3f> cloud = log ? vegetation_of(file) : cloud_of(file);
    if (cloud.size() < 30) {
      result.notes.push_back(name + " was left out: fewer than 30 points");
      continue;
    }
    const LeafInclination leaves = metrics::leaf_inclination(cloud);
    std::vector<std::string> row{name};
    for (std::string& cell : cells(leaves)) row.push_back(std::move(cell));
    table.rows.push_back(std::move(row));
    result.figures["real"][name] = json_of(leaves);
    result.inputs.push_back(file);
  }
  if (table.rows.empty()) {
    result.notes.emplace_back(
        "real vegetation was left out: no --data folder with point files or logs with train.ply");
  } else {
    result.tables.push_back(table);
  }
}

StudyResult study_mesh_fidelity(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "Plants from a billboard to millions of triangles, scanned from an approaching vehicle: do "
      "the leaves of the cloud stand as those of real vegetation in Goodin et al. 2024?";
  std::vector<PlantFigures> plants;
  std::vector<double> count, epsilon;
  BeamLog finest;
  for (const SweepPlant& plant : sweep_plants(run.quick, run.seed)) {
    BeamLog scan = approach_scan(plant.plant, approach_beams(plant.plant, run.quick), run.seed);
    plants.push_back(figures_of(plant, scan));
    const PlantFigures& p = plants.back();
    run.say(fmt::format("{}: {} triangles, ε = {:.3f}", p.name, p.elements, p.leaves.epsilon()));
    count.push_back(double(p.elements));
    epsilon.push_back(p.leaves.epsilon());
    finest = std::move(scan);
  }
  const metrics::LogRegression line = metrics::log_regression(count, epsilon);
  result.checks = sweep_checks(plants, line);
  std::vector<PlantFigures> shown = plants;
  shown.push_back(ellipsoids_of(finest, run.seed));
  shown.back().name = "ellipsoids of the last";
  for (const PlantFigures& p : shown) {
    Json j = json_of(p.leaves);
    j["elements"] = p.elements;
    j["bytes"] = p.bytes;
    result.figures["plants"][p.name] = j;
  }
  result.figures["regression"] = {{"a", line.a}, {"b", line.b}, {"r2", line.r2}};
  result.tables.push_back(sweep_table(shown));
  result.tables.push_back(line_table(plants, line));
  result.pictures = picture(plants, line);
  add_real_vegetation(run, result);
  return result;
}

}  // namespace underbrush::app
