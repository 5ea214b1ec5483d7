#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/verification.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "studies/planar_patches.hpp"
#include "underbrush/simulate/simulate.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr double kVehicleM = 3;     // nearer returns are of the vehicle itself
constexpr double kFarM = 40;        // further away the rings lie too far apart to tell planes
constexpr double kOnPlaneM = 0.15;  // a real return further off is of something else

/// The first scan of a log.
BeamLog first_scan(const fs::path& file) {
  io::LogReader reader(file);
  BeamLog chunk, out;
  out.info = reader.info();
  while (reader.next(chunk)) {
    const uint32_t scan = out.empty() ? chunk.scan.at(0) : out.scan[0];
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (chunk.scan[i] != scan) return out;
      out.append(chunk, i);
    }
  }
  return out;
}

bool is_used(const BeamLog& log, size_t i) {
  return log.is_hit(i) && log.range_m[i] > kVehicleM && log.range_m[i] < kFarM;
}

report::Table table_of(const std::string& log, const WallFigures& f) {
  report::Table table{"Planes of a real scan: " + log,
                   fmt::format("The nine largest planar patches of the train half's first scan, as "
                               "faces; beams of the test half's first scan answered by them with "
                               "σ = {:.0f} mm. Absolute distance from the train half's planes, "
                               "mean ± standard deviation, mm. Range histograms of the same beams: "
                               "mean |Δshare| {:.3f} %, largest {:.3f} %.",
                               1e3 * f.range_sigma_m, 100 * f.histograms.mean_difference(),
                               100 * f.histograms.largest_difference()),
                   {"patch", "tilt of the normal, deg", "train points", "test points", "real",
                    "real offset", "simulated", "simulated offset"},
                   {}};
  for (size_t k = 0; k < f.patches.size(); ++k) {
    const WallFigures::Patch& p = f.patches[k];
    const double tilt = std::acos(std::min(1.0, std::abs(p.plane.normal.z()))) * 180 / M_PI;
    const auto both = [](const Distances& d) {
      return fmt::format("{:.1f} ± {:.1f}", 1e3 * d.mean_m, 1e3 * d.sigma_m);
    };
    table.rows.push_back({fmt::format("{}", k + 1), fmt::format("{:.1f}", tilt),
                          fmt::format("{}", p.train_points), fmt::format("{}", p.real.points),
                          both(p.real), fmt::format("{:+.1f}", 1e3 * p.real.offset_m),
                          both(p.simulated), fmt::format("{:+.1f}", 1e3 * p.simulated.offset_m)});
  }
  return table;
}

}  // namespace

WallFigures compare_walls(const BeamLog& train, const BeamLog& test, uint64_t seed) {
  require(!train.empty() && !test.empty(), "walls: a log without beams");
  const Vec3 origin = train.origin[0];
  std::vector<Vec3f> cloud;
  for (size_t i = 0; i < train.size(); ++i) {
    if (is_used(train, i)) cloud.push_back((train.end_point(i) - origin).cast<float>());
  }
  const std::vector<PlanarPatch> found = planar_patches(cloud, {});
  require(!found.empty(), "walls: no planar patch");
  Solid faces;
  WallFigures out;
  double variance = 0;
  for (const PlanarPatch& patch : found) {
    std::vector<uint32_t> corners;
    for (const Vec3& corner : patch.outline) {
      corners.push_back(uint32_t(faces.vertices.size()));
      faces.vertices.push_back(corner);
    }
    faces.faces.push_back(std::move(corners));
    out.patches.push_back({patch.plane, patch.points.size(), {}, {}});
    variance += patch.plane.variance / double(found.size());
  }
  out.range_sigma_m = std::sqrt(variance);
  SolidMesh mesh = triangulated(faces);
  elements::Model model;
  model.origin = origin;
  model.surface = std::move(mesh.mesh);
  model.surface.range_sigma_m = out.range_sigma_m;
  const trace::World world(model);
  BeamLog simulated = test;
  simulate::Options options;
  options.seed = seed;
  options.element_ids = true;
  simulate::simulate(world, options, 0, simulated);
  const auto& element = std::get<std::vector<uint32_t>>(simulated.extra.at("element"));
  std::vector<std::vector<Vec3>> real_points(found.size()), simulated_points(found.size());
  std::vector<double> real_range, simulated_range;
  for (size_t i = 0; i < test.size(); ++i) {
    if (!simulated.is_hit(i) || !is_used(test, i)) continue;
    const size_t face = mesh.face[element[i]];
    const Vec3 real = test.end_point(i) - origin;
    if (std::abs(out.patches[face].plane.distance(real)) > kOnPlaneM) continue;
    real_points[face].push_back(real);
    simulated_points[face].push_back(simulated.end_point(i) - origin);
    real_range.push_back(double(test.range_m[i]));
    simulated_range.push_back(double(simulated.range_m[i]));
  }
  for (size_t f = 0; f < found.size(); ++f) {
    out.patches[f].real = distances_from(out.patches[f].plane, real_points[f]);
    out.patches[f].simulated = distances_from(out.patches[f].plane, simulated_points[f]);
  }
  out.histograms = range_histograms(real_range, simulated_range, 0.25);
  return out;
}

void add_walls(const StudyRun& run, StudyResult& result) {
  std::vector<fs::path> logs;
  if (!run.data.empty()) {
    for (const auto& entry : fs::directory_iterator(run.data)) {
      if (fs::exists(entry.path() / "train.ply") && fs::exists(entry.path() / "test.ply"))
        logs.push_back(entry.path());
    }
  }
  std::sort(logs.begin(), logs.end());
  if (logs.empty()) {
    result.notes.emplace_back(
        "real scans of planar surfaces were left out: no --data folder of logs with train.ply and "
        "test.ply");
  }
  for (const fs::path& log : logs) {
    const std::string name = log.filename().string();
    run.say("planes of " + name);
    WallFigures f;
    try {
      f = compare_walls(first_scan(log / "train.ply"), first_scan(log / "test.ply"), run.seed);
    } catch (const std::invalid_argument& e) {
      result.notes.push_back(name + " was left out: " + e.what());
      continue;
    }
    result.tables.push_back(table_of(name, f));
    Json patches = Json::array();
    for (const WallFigures::Patch& p : f.patches) {
      patches.push_back({{"test_points", p.real.points},
                         {"real_m", p.real.mean_m},
                         {"real_offset_m", p.real.offset_m},
                         {"simulated_m", p.simulated.mean_m},
                         {"simulated_offset_m", p.simulated.offset_m}});
    }
    result.figures["walls"][name] = {
        {"patches", patches},
        {"range_sigma_m", f.range_sigma_m},
        {"histogram_largest_share_difference", f.histograms.largest_difference()},
        {"histogram_mean_share_difference", f.histograms.mean_difference()}};
    result.pictures += histogram_picture(name, f.histograms);
    result.inputs.push_back(log / "train.ply");
    result.inputs.push_back(log / "test.ply");
  }
}

}  // namespace underbrush::studies
