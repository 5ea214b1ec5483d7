#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/verification_checks.hpp"
#include "studies/verification_walls.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr double kSpread = 1.25;                // Spreads may differ by this factor.
constexpr double kOffsetM = 0.005;              // m; half of the bias that must be caught.
constexpr double kLeanRad = 0.25 * M_PI / 180;  // Half of the lean that must be caught.
constexpr size_t kLeastScansOfWalls = 4;

/// Returns the walls of all scans, as `source` answers them.
WallFigures figures_of(const std::vector<WallScan>& scans, WallSource source,
                       const ScannerFault& fault, uint64_t seed) {
  std::vector<std::vector<Wall>> walls;
  walls.reserve(scans.size());
  for (const WallScan& scan : scans) {
    walls.push_back(scan.compare(source, fault, seed + walls.size()));
  }
  return wall_figures(walls);
}

std::vector<WallScan> walls_of(const fs::path& file) {
  const BeamLog log = io::read_log(file);
  std::vector<WallScan> out;
  for (size_t begin = 0, end = 0; begin < log.size(); begin = end) {
    while (end < log.size() && log.scan[end] == log.scan[begin]) ++end;
    BeamLog scan = log.like();
    scan.append(log, begin, end);
    try {
      out.emplace_back(scan);
    } catch (const std::invalid_argument&) {
      continue;  // No wall in this scan.
    }
  }
  return out;
}

std::string interval(const Bounded& b, double unit) {
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", unit * b.mean, unit * b.low, unit * b.high);
}

Json json_of(const Bounded& b) { return {{"mean", b.mean}, {"low", b.low}, {"high", b.high}}; }

void add_row(const std::string& log, const char* name, const WallFigures& f, report::Table& table,
             Json& figures) {
  table.rows.push_back({fmt::format("{}/{}", log, name), std::to_string(f.walls),
                        std::to_string(f.beams), interval(f.spread, 1), interval(f.offset_m, 1e3),
                        interval(f.lean_rad, 180 / M_PI)});
  figures[log][name] = {{"walls", f.walls},
                        {"beams", f.beams},
                        {"spread", json_of(f.spread)},
                        {"offset_m", json_of(f.offset_m)},
                        {"lean_rad", json_of(f.lean_rad)}};
}

}  // namespace

WallFigures wall_figures(const std::vector<std::vector<Wall>>& scans) {
  WallFigures out;
  std::vector<double> spread, offset, lean;
  for (const std::vector<Wall>& walls : scans) {
    if (walls.empty()) continue;
    const double n = double(walls.size());
    double log_ratio = 0, sum = 0, lean_sum = 0, lean_weight = 0;
    for (const Wall& w : walls) {
      log_ratio += 0.5 * std::log(w.simulated.variance / w.real.variance) / n;
      sum += w.offset_m / n;
      lean_sum += w.lean_sum;
      lean_weight += w.lean_weight;
      out.beams += w.points;
    }
    ++out.scans;
    out.walls += walls.size();
    spread.push_back(log_ratio);
    offset.push_back(sum);
    lean.push_back(lean_sum / lean_weight);
  }
  const Bounded ratio = bounded(spread);
  out.spread = {std::exp(ratio.mean), std::exp(ratio.low), std::exp(ratio.high)};
  out.offset_m = bounded(offset);
  out.lean_rad = bounded(lean);
  return out;
}

std::vector<Check> wall_checks(const std::string& what, const WallFigures& f) {
  std::vector<Check> out;
  const auto within = [&](const char* name, const Bounded& b, double low, double high) {
    out.push_back({fmt::format("{}, {}, lower bound", what, name), b.low, low, false});
    out.push_back({fmt::format("{}, {}, upper bound", what, name), b.high, high});
  };
  within("spread about a wall, simulated / measured", f.spread, 1 / kSpread, kSpread);
  within("simulated − measured range of a wall (m)", f.offset_m, -kOffsetM, kOffsetM);
  within("lean of the mirror (rad)", f.lean_rad, -kLeanRad, kLeanRad);
  return out;
}

void add_walls(const StudyRun& run, StudyResult& result) {
  const std::vector<fs::path> logs =
      run.data.empty() ? std::vector<fs::path>{} : halved_logs(run.data);
  if (logs.empty()) {
    result.notes.emplace_back(
        "walls of real scans were left out: no --data folder of logs with train.ply and test.ply");
    return;
  }
  report::Table table{"Walls of real scans",
                      "Upright planes of every other beam of a scan answer the beams between them. "
                      "Means over scans with 99 % confidence intervals; lean: of the mirror, as "
                      "the differences of the ranges estimate it.",
                      {"log/simulator", "walls", "beams", "spread, simulated / measured",
                       "simulated − measured range, mm", "lean, degrees"},
                      {}};
  report::Table caught{"Faults on real walls",
                       "Simulators with a fault, and how many checks catch them.",
                       {"place", "fault", "checks that fail", "the first of them"},
                       {}};
  for (const fs::path& log : logs) {
    const std::string name = log.filename().string();
    run.say("walls of " + name);
    const std::vector<WallScan> scans = walls_of(log / "test.ply");
    result.inputs.push_back(log / "test.ply");
    if (scans.size() < kLeastScansOfWalls) {
      result.notes.push_back(name + " was left out: fewer than four scans with a wall");
      continue;
    }
    const std::pair<const char*, WallSource> sources[] = {
        {"planes", WallSource::kFaces},
        {"planes, data sheet's noise", WallSource::kDataSheet},
        {"default fit", WallSource::kFit}};
    std::vector<Check> sound;  // The checks of the simulator that the faults are put into.
    for (const auto& [title, source] : sources) {
      const WallFigures f = figures_of(scans, source, {}, run.seed);
      add_row(name, title, f, table, result.figures["walls"]);
      for (const Check& c : wall_checks(name + ", " + title, f)) result.checks.push_back(c);
      if (source == WallSource::kFaces) sound = wall_checks(name, f);
    }
    for (const NamedFault& fault : faults()) {
      const WallFigures f = figures_of(scans, WallSource::kFaces, fault.fault, run.seed);
      add_row(name, fault.name, f, table, result.figures["walls"]);
      add_fault(name, fault.name, sound, wall_checks(name, f), caught, result);
    }
  }
  result.tables.push_back(std::move(table));
  result.tables.push_back(std::move(caught));
}

}  // namespace underbrush::studies
