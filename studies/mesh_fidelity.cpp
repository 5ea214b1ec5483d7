#include "studies/mesh_fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/studies.hpp"
#include "report/svg_plot.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/export.hpp"

namespace underbrush::studies {
namespace {

using metrics::LeafInclination;
constexpr double kVolumeM3 = 45;
constexpr size_t kMostOfBoards = 8;  // triangles; a cartoon has more

report::Table sweep_table(const std::vector<PlantFigures>& plants) {
  report::Table table{
      "Plants in a box of 45 m³, two OS1-64 on an approaching vehicle",
      "μ, σ: of arccos n_z, rad; ε from (1.65, 0.747), inside: ε ≤ 0.11. Gap: of the distribution "
      "to "
      "the Gaussian of that μ and σ. ≥ 5/8: as many elements "
      "as 5/8 of the points. Memory: of "
      "vertices and triangles, or of the ellipsoids. Poses exact, as a simulator knows them; "
      "odometry: the same scans registered to 2 cm and 0.1°.",
      {"plant", "elements", "per m³", "kB", "points", "μ", "σ", "ε", "criterion", "gap", "≥ 5/8",
       "ε, odometry"},
      {}};
  for (const PlantFigures& p : plants) {
    std::vector<std::string> row{p.name, fmt::format("{}", p.elements),
                                 fmt::format("{:.0f}", double(p.elements) / kVolumeM3),
                                 fmt::format("{:.0f}", double(p.bytes) / 1e3)};
    for (std::string& cell : cells(p.leaves)) row.push_back(std::move(cell));
    row.emplace_back(8 * p.elements >= 5 * p.leaves.points ? "yes" : "no");
    row.push_back(fmt::format("{:.3f}", p.displaced.epsilon()));
    table.rows.push_back(std::move(row));
  }
  return table;
}

using Score = LeafInclination PlantFigures::*;

/// The least count of a plant inside the criterion, infinite if there is none.
double least_inside(const std::vector<PlantFigures>& plants, Score score,
                    const std::string& kind = "") {
  double least = INFINITY;
  for (const PlantFigures& p : plants) {
    if (p.crude || p.name.rfind(kind, 0) != 0 || !(p.*score).is_realistic()) continue;
    least = std::min(least, double(p.elements));
  }
  return least;
}

/// Over the plants whose name begins with `kind`, boards and cartoons with them; empty: over all.
metrics::LogRegression line_of(const std::vector<PlantFigures>& plants, Score score,
                               const std::string& kind = "") {
  std::vector<double> count, epsilon;
  for (const PlantFigures& p : plants) {
    if (!p.crude && p.name.rfind(kind, 0) != 0) continue;
    count.push_back(double(p.elements));
    epsilon.push_back((p.*score).epsilon());
  }
  return metrics::log_regression(count, epsilon);
}

report::Table line_table(const std::vector<PlantFigures>& plants, Json& figures) {
  report::Table table{"ε = a − b ln n",
                   "Minimum: the coarsest plant inside the criterion that is no cartoon; "
                   "recommended: where the line is at 0.11, none below 10⁹. Triangles per m³. "
                   "Samples: median of "
                   "the plants; the rule asks for 5/8 of them in triangles.",
                   {"", "a", "b", "R²", "minimum", "recommended", "samples", "rule"},
                   {}};
  const auto density = [](double n) {
    const double most = 1e9 * kVolumeM3;  // more than anyone could store
    return n < most ? fmt::format("{:.0f}", n / kVolumeM3) : "none";
  };
  std::vector<double> samples;
  samples.reserve(plants.size());
  for (const PlantFigures& p : plants) samples.push_back(double(p.leaves.points) / kVolumeM3);
  std::nth_element(samples.begin(), samples.begin() + std::ptrdiff_t(samples.size() / 2),
                   samples.end());
  const double median = samples[samples.size() / 2];
  const auto add = [&](const std::string& name, Score score, const std::string& kind) {
    const metrics::LogRegression line = line_of(plants, score, kind);
    table.rows.push_back({name, fmt::format("{:.3f}", line.a), fmt::format("{:.4f}", line.b),
                          fmt::format("{:.3f}", line.r2),
                          density(least_inside(plants, score, kind)),
                          density(line.count_at(LeafInclination::kLargest)),
                          fmt::format("{:.0f}", median), fmt::format("{:.0f}", 0.625 * median)});
    figures[name] = {{"a", line.a}, {"b", line.b}, {"r2", line.r2}};
  };
  add("exact poses", &PlantFigures::leaves, "");
  for (const std::string kind : {"broadleaf", "shrub", "conifer"}) {
    const auto is_one = [&](const PlantFigures& p) { return p.name.rfind(kind, 0) == 0; };
    if (!std::any_of(plants.begin(), plants.end(), is_one)) continue;
    add("boards, cartoons, " + kind, &PlantFigures::leaves, kind);
  }
  add("odometry", &PlantFigures::displaced, "");
  table.rows.push_back(
      {"published", "0.269", "0.0121", "0.635", "1600", "11000", "17000", "11000"});
  return table;
}

std::string picture(const std::vector<PlantFigures>& plants, const metrics::LogRegression& line) {
  report::SvgPlot plot(
      "Realism distance against the number of triangles; the line through it, grey the published, "
      "red "
      "the criterion",
      "log10 triangles", "ε, rad");
  report::SvgPlot::Points points;
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
  plot.line({{0, 0.269}, {7, 0.269 - 0.0121 * 7 * M_LN10}}, "#999", true);
  plot.line({{0, LeafInclination::kLargest}, {7, LeafInclination::kLargest}}, "#c33", true);
  return plot.svg();
}

}  // namespace

Json json_of(const LeafInclination& l) {
  return {{"points", l.points},
          {"mean_rad", l.mean_rad},
          {"sigma_rad", l.sigma_rad},
          {"epsilon", l.epsilon()},
          {"gaussian_gap", l.gaussian_gap()},
          {"realistic", l.is_realistic()}};
}

std::vector<std::string> cells(const LeafInclination& l) {
  return {fmt::format("{}", l.points),
          fmt::format("{:.3f}", l.mean_rad),
          fmt::format("{:.3f}", l.sigma_rad),
          fmt::format("{:.3f}", l.epsilon()),
          l.is_realistic() ? "inside" : "outside",
          fmt::format("{:.3f}", l.gaussian_gap())};
}

std::vector<Check> sweep_checks(const std::vector<PlantFigures>& plants,
                                const metrics::LogRegression& line) {
  std::vector<Check> out;
  for (const bool board : {true, false}) {
    double least = INFINITY;
    for (const PlantFigures& p : plants) {
      if (p.crude && (p.elements <= kMostOfBoards) == board) {
        least = std::min(least, p.leaves.epsilon());
      }
    }
    out.push_back({fmt::format("{} lie outside, least ε", board ? "boards" : "cartoons"), least,
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

StudyResult study_mesh_fidelity(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "Plants from a billboard to millions of triangles, scanned from an approaching vehicle: do "
      "the leaves of the cloud stand as those of real vegetation in Goodin et al. 2024?";
  std::vector<PlantFigures> plants, ellipsoids;
  const std::vector<SweepPlant> sweep = sweep_plants(run.quick, run.seed);
  const auto scan_of = [&run](const SweepPlant& plant) {
    return approach_scan(plant.plant, approach_beams(plant.plant, run.quick, {}), run.seed);
  };
  const auto told = [&run](const PlantFigures& p) {
    run.say(fmt::format("{}: {} triangles, {} points, ε = {:.3f}", p.name, p.elements,
                        p.leaves.points, p.leaves.epsilon()));
  };
  const auto kind = [](const SweepPlant& p) { return p.name.substr(0, p.name.find(' ')); };
  for (size_t k = 0; k < sweep.size(); ++k) {
    const BeamLog scan = scan_of(sweep[k]);
    if (!run.keep.empty()) {
      std::filesystem::create_directories(run.keep);
      io::export_log(run.keep / (sweep[k].name + ".ply"), scan, "", "{}");
    }
    plants.push_back(figures_of(sweep[k], scan, run.seed));
    told(plants.back());
    const bool finest = k + 1 == sweep.size() || kind(sweep[k + 1]) != kind(sweep[k]);
    if (!finest || sweep[k].crude) continue;
    ellipsoids.push_back(ellipsoids_of(scan, run.seed));
    ellipsoids.back().name = "ellipsoids of " + sweep[k].name;
  }
  std::vector<PlantFigures> shown = plants;
  shown.insert(shown.end(), ellipsoids.begin(), ellipsoids.end());
  for (const SweepPlant& plant : given_plants(run.data / "meshes")) {
    shown.push_back(figures_of(plant, scan_of(plant), run.seed));
    shown.back().name += ", given";
    told(shown.back());
  }
  for (const PlantFigures& p : shown) {
    Json j = json_of(p.leaves);
    j["elements"] = p.elements;
    j["bytes"] = p.bytes;
    j["odometry"] = json_of(p.displaced);
    result.figures["plants"][p.name] = j;
  }
  const metrics::LogRegression line = line_of(plants, &PlantFigures::leaves);
  result.checks = sweep_checks(plants, line);
  result.tables.push_back(sweep_table(shown));
  result.tables.push_back(line_table(plants, result.figures["regression"]));
  result.pictures = picture(plants, line);
  const auto finest =
      std::max_element(sweep.begin(), sweep.end(), [](const SweepPlant& a, const SweepPlant& b) {
        return a.plant.mesh.size() < b.plant.mesh.size();
      });
  add_conditions(run, *finest, result);
  add_sensors(run, sweep, result);
  add_real_vegetation(run, result);
  return result;
}

}  // namespace underbrush::studies
