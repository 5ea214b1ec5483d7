#include "studies/vegetation_repeats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "studies/extrapolation.hpp"
#include "studies/planar_patches.hpp"
#include "studies/primitives.hpp"
#include "studies/registration.hpp"
#include "studies/vegetation.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/metrics/always_hit.hpp"
#include "underbrush/metrics/look_up.hpp"
#include "underbrush/metrics/repeats.hpp"
#include "underbrush/metrics/scan_pairs.hpp"
#include "underbrush/pipeline/fit_model.hpp"
#include "underbrush/pipeline/simulate_log.hpp"
#include "underbrush/sensor/sensor.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr double kStandsM = 0.05;  // m from scan to scan.
constexpr size_t kLeastScans = 4;
constexpr double kUpright = 0.5;
constexpr int kAbout = 3;  // Beams to each side.

using metrics::RepeatedScans;
using metrics::Repeats;

/// Returns the target (`kTargets`, less "all") of each return, and `kTargetCount` for no target.
std::vector<size_t> kinds_of(const BeamLog& scan, const std::vector<uint8_t>& label) {
  std::vector<size_t> kind(scan.size(), kTargetCount);
  std::vector<Vec3f> cloud;
  std::vector<uint32_t> beam;
  for (size_t i = 0; i < scan.size(); ++i) {
    if (!scan.is_hit(i) || scan.range_m[i] < kVehicleM) continue;
    const auto c = elements::Class(label[i]);
    if (c >= elements::Class::kSmallTree && c <= elements::Class::kLargeTree) {
      kind[i] = 0;
    } else if (c >= elements::Class::kLowShrub) {
      kind[i] = 1;
    }
    cloud.push_back((scan.end_point(i) - scan.origin[0]).cast<float>());
    beam.push_back(uint32_t(i));
  }
  PatchOptions options;
  options.most_patches = 40;
  if (cloud.size() < options.least_points) return kind;
  for (const PlanarPatch& patch : planar_patches(cloud, options)) {
    if (std::abs(patch.plane.normal.z()) > kUpright) continue;
    for (const uint32_t k : patch.points) kind[beam[k]] = 2;
  }
  return kind;
}

/// A simulation of a test log, and its name.
struct Answered {
  std::string name;
  BeamLog log;
};

std::vector<Answered> answers(const StudyRun& run, const BeamLog& train, const BeamLog& test) {
  std::vector<Answered> out{
      {"look-up, raw", metrics::looked_up(train, test, metrics::LookUp::kRaw)},
      {"look-up, 2 scans", metrics::looked_up(train, test, metrics::LookUp::kWarped2)},
      {"always hit", metrics::always_hit(train, test)}};
  for (Contender c : mobile_contenders(run.seed)) {
    run.say("  " + c.name);
    c.fit.min_range_m = kVehicleM;
    MemorySource source(train);
    const elements::Model model = pipeline::fit_model({source}, c.fit).model;
    std::vector<bool> cones{false};
    if (is_surface(c) && !test.info.sensor.empty()) cones.push_back(true);
    for (const bool cone : cones) {
      pipeline::SimulateOptions options;
      options.seed = run.seed;
      options.matter = c.once ? "once" : "anew";
      if (cone) options.beam = "random";
      out.push_back({is_surface(c) ? c.name + (cone ? ", cone" : ", axis") : c.name,
                     pipeline::simulate_log(model, test, options)});
    }
  }
  return out;
}

/// Compares one simulation on each target.
std::vector<Repeats> repeats_of(const BeamLog& test, const BeamLog& simulated,
                                const std::vector<uint8_t>& label) {
  std::vector<RepeatedScans> scans(kTargetCount);
  MemorySource a(test), b(simulated);
  size_t first = 0;
  metrics::for_each_scan(a, b, [&](const BeamLog& real, const BeamLog& ours) {
    const std::vector<uint8_t> own(label.begin() + std::ptrdiff_t(first),
                                   label.begin() + std::ptrdiff_t(first + real.size()));
    const std::vector<std::vector<bool>> targets = targets_of(real, own);
    for (size_t t = 0; t < kTargetCount; ++t) scans[t].add(real, ours, targets[t]);
    first += real.size();
  });
  std::vector<Repeats> out;
  out.reserve(scans.size());
  for (const RepeatedScans& s : scans) out.push_back(s.finish());
  return out;
}

bool stands(const LogInfo& info) {
  const Path path = path_of(info.scans);
  return path.scan.size() >= kLeastScans && path.at_m.back() <= kStandsM * double(path.scan.size());
}

/// Returns how far the sensor moved from the first scan of a log to the second, beyond what the
/// poses say, by registration of what stands 8 to 50 m away (m); NaN for fewer than two scans.
double unposed_motion_m(const BeamLog& log) {
  std::vector<Vec3> cloud[2];
  size_t scan = 0;
  for (size_t i = 0; i < log.size() && scan < 2; ++i) {
    if (i > 0 && log.scan[i] != log.scan[i - 1] && ++scan == 2) break;
    const Vec3 p = log.end_point(i) - log.origin[0];
    const bool stands = log.is_hit(i) && log.range_m[i] > 8 && log.range_m[i] < 50 && p.z() > -1.3;
    if (stands) cloud[scan].push_back(p);
  }
  if (cloud[1].size() < 10) return NAN;
  return icp(cloud[1], cloud[0]).to_from_from.translation.norm();
}

void add_row(const std::string& log, const std::string& name, const std::vector<Repeats>& targets,
             report::Table& table, StudyResult& result) {
  table.rows.push_back({fmt::format("{}/{}", log, name)});
  for (size_t t = 0; t < kTargetCount; ++t) {
    const Repeats& r = targets[t];
    table.rows.back().push_back(fmt::format("{:.3f} / {:.3f}", r.same_scans, r.distance));
    result.figures["repeats"][log][name][kTargets[t]] = {
        {"distance", r.distance},
        {"same_scans", r.same_scans},
        {"floor", r.floor},
        {"difference_m", r.difference_m},
        {"real_difference_m", r.real_difference_m},
        {"real_far_difference_m", r.real_far_difference_m}};
  }
  table.rows.back().push_back(fmt::format("{:.2f}", 100 * targets.back().difference_m));
}

}  // namespace

std::vector<std::vector<bool>> targets_of(const BeamLog& scan, const std::vector<uint8_t>& label) {
  const std::vector<size_t> kind = kinds_of(scan, label);
  std::map<uint16_t, std::vector<size_t>> rings;
  for (size_t i = 0; i < scan.size(); ++i) rings[scan.ring[i]].push_back(i);
  std::vector<std::vector<bool>> out(kTargetCount, std::vector<bool>(scan.size()));
  out.back().assign(scan.size(), true);
  for (const auto& [ring, beams] : rings) {
    const int n = int(beams.size());
    for (int k = 0; k < n; ++k) {
      int returns = 0, of[kTargetCount] = {};
      for (int j = std::max(0, k - kAbout); j <= std::min(n - 1, k + kAbout); ++j) {
        returns += scan.is_hit(beams[size_t(j)]);
        const size_t target = kind[beams[size_t(j)]];
        if (target < kTargetCount) ++of[target];
      }
      for (size_t t = 0; t + 1 < kTargetCount; ++t) {
        if (2 * of[t] > returns) out[t][beams[size_t(k)]] = true;
      }
    }
  }
  return out;
}

void add_repeated_logs(const StudyRun& run, StudyResult& result) {
  report::Table table{
      "Bearing × range histograms of real scans",
      "Bhattacharyya distance over laser × bearing × range bins of 0.2° × 5 cm and a no-return "
      "bin, "
      "of the same scans / of even measured and odd simulated scans. The first row is scan against "
      "scan. Last column: median difference of a direction's range from scan to scan.",
      {"log/model", "trees", "hedges", "walls", "all", "scan to scan, cm"},
      {}};
  std::vector<fs::path> logs;
  if (!run.data.empty()) logs = halved_logs(run.data);
  for (const fs::path& log : logs) {
    if (!stands(io::LogReader(log / "test.ply").info())) continue;
    const std::string name = log.filename().string();
    run.say("repeated scans of " + name);
    const BeamLog train = io::read_log(log / "train.ply");
    BeamLog test = io::read_log(log / "test.ply"), labelled = test;
    label_log(labelled, kVehicleM);
    std::vector<uint8_t> label;
    std::visit([&](const auto& c) { label.assign(c.begin(), c.end()); },
               labelled.extra.at("class"));
    for (const Answered& a : answers(run, train, test)) {
      const std::vector<Repeats> targets = repeats_of(test, a.log, label);
      if (a.name == "look-up, raw") {
        std::vector<Repeats> floor = targets;
        for (Repeats& r : floor) {
          r.distance = r.floor;
          r.same_scans = 0;
          r.difference_m = r.real_difference_m;
        }
        add_row(name, "measured", floor, table, result);
        const double moved = unposed_motion_m(test);
        result.figures["motion_m"][name] = moved;
        if (!targets.back().repeat()) {
          result.notes.push_back(fmt::format(
              "{}: the scans do not repeat: ranges of one direction differ by {:.1f} cm from scan "
              "to scan, but by {:.1f} cm between scans half the log apart; registration of the "
              "first two scans says that the sensor moved by {:.2f} m more than its poses say",
              name, 100 * targets.back().real_difference_m,
              100 * targets.back().real_far_difference_m, moved));
        }
      }
      add_row(name, a.name, targets, table, result);
    }
    result.inputs.push_back(log / "train.ply");
    result.inputs.push_back(log / "test.ply");
  }
  if (table.rows.empty()) {
    result.notes.emplace_back(
        "repeated scans were left out: no log of a standing sensor in --data");
    return;
  }
  result.tables.push_back(std::move(table));
}

}  // namespace underbrush::studies
