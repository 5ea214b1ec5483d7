#include "studies/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/studies.hpp"
#include "studies/verification_checks.hpp"
#include "studies/verification_tables.hpp"
#include "studies/verification_walls.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"
#include "underbrush/metrics/leaf_cloud.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

/// Returns the point file whose name without extension is `stem`, or none.
fs::path cloud_file(const fs::path& folder, const std::string& stem) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().stem() == stem && io::is_table_file(entry.path())) return entry.path();
  }
  return {};
}

}  // namespace

void add_miniature(const StudyRun& run, StudyResult& result,
                   const std::function<void(Solid&)>& change) {
  const Solid target = miniature();
  Solid simulated = target;
  if (change) change(simulated);
  const Pose pose = miniature_from_scanner();
  // The pose is known to 3° and 5 cm, as with a tape measure; the registration must find the rest.
  Pose guess = pose.inverse();
  guess.rotation = Eigen::AngleAxisd(3 * M_PI / 180, Vec3::UnitZ()) * guess.rotation;
  guess.translation += Vec3(0.05, -0.05, 0.03);
  CloudPair pair{{}, {}, guess};
  std::vector<Vec3> again;         // A second scan by the same instrument, with its raster shifted
                                   // differently.
  std::vector<Vec3> all_sub_rays;  // The simulated scans with each sub-ray traced.
  const int scans = run.quick ? 2 : 16;
  PairFigures one, one_again;
  std::vector<std::vector<Vec3>> seen(2 * size_t(scans));
  parallel_for(seen.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) seen[k] = instrument_scan(target, pose, int(k), run.seed);
  });
  for (int k = 0; k < scans; ++k) {
    const std::vector<Vec3>& real = seen[size_t(k)];
    const SimulatedScan ours = simulated_scan(simulated, pose, k, run.seed + uint64_t(k));
    pair.real.insert(pair.real.end(), real.begin(), real.end());
    pair.simulated.insert(pair.simulated.end(), ours.points.begin(), ours.points.end());
    const SimulatedScan full = simulated_scan(simulated, pose, k, run.seed + uint64_t(k), {}, true);
    all_sub_rays.insert(all_sub_rays.end(), full.points.begin(), full.points.end());
    for (const Vec3& p : seen[size_t(k) + size_t(scans)]) again.push_back(pose * p);
    if (k == 0) {
      if (!run.keep.empty()) keep_pair(run.keep, pair);
      one = compare(target, miniature_patches(), pair);
      one_again = compare(target, miniature_patches(), {pair.real, again, guess});
      run.say(fmt::format("one scan: {} shots, {} points, simulated {}", ours.shots, real.size(),
                          ours.points.size()));
    }
  }
  const PairFigures all = compare(target, miniature_patches(), pair);
  const PairFigures all_traced =
      compare(target, miniature_patches(), {pair.real, std::move(all_sub_rays), guess});
  const PairFigures all_again =
      compare(target, miniature_patches(), {std::move(pair.real), std::move(again), guess});
  const bool nine = one.by_icp.patches.size() == 9;
  result.tables.push_back(plane_table("Planes of the real cloud (Table 3)", one, nine));
  result.tables.push_back(distance_table("Distances from the planes (Table 4)", one, nine));
  const std::string many = fmt::format("{} scans", scans);
  result.tables.push_back(histogram_table("Range histograms (Fig. 7)",
                                          {"one scan", "one scan, real against real", many,
                                           many + ", --all-sub-rays", many + ", real against real"},
                                          {&one, &one_again, &all, &all_traced, &all_again}));
  result.figures["miniature"] = json_of(one);
  result.figures["miniature_again"] = json_of(one_again);
  result.figures["miniature_scans"] = json_of(all);
  result.figures["miniature_scans_all_sub_rays"] = json_of(all_traced);
  result.figures["miniature_scans_again"] = json_of(all_again);
  result.figures["miniature_scans"]["scans"] = scans;
  result.checks.push_back({"patches seen", double(one.by_icp.patches.size()), 9, false});
  std::vector<Check> sound = pair_checks("one scan", one);
  for (const Check& c : survey_checks("one scan", one, pose.inverse())) sound.push_back(c);
  result.checks.insert(result.checks.end(), sound.begin(), sound.end());
  result.checks.push_back({many + ", largest difference of the normalised histograms",
                           all.by_icp.histograms.largest_difference(), kHistogramShare});
  result.pictures += histogram_picture("One scan", one.by_icp.histograms);
  result.pictures += histogram_picture(many, all.by_icp.histograms);
  if (!change) add_faults(run, target, pose, {seen[0], {}, guess}, sound, result);
}

bool add_own_pair(const StudyRun& run, StudyResult& result) {
  if (run.data.empty()) return false;
  const fs::path real = cloud_file(run.data, "real"), simulated = cloud_file(run.data, "simulated");
  if (real.empty() || simulated.empty()) return false;
  Solid target = miniature();
  std::vector<size_t> faces = miniature_patches();
  for (const char* name : {"target.json", "target.obj"}) {
    if (!fs::exists(run.data / name)) continue;
    target = read_solid(run.data / name);
    faces.resize(target.faces.size());
    for (size_t f = 0; f < faces.size(); ++f) faces[f] = f;
    result.inputs.push_back(run.data / name);
  }
  CloudPair pair{metrics::points_of(real), metrics::points_of(simulated), {}};
  const fs::path conjugates = run.data / "conjugates.csv";
  if (fs::exists(conjugates)) {
    std::vector<Vec3> from, to;
    const io::NumberRows rows = io::read_numbers(conjugates);
    for (size_t i = 0; i < rows.rows.size(); ++i) {
      const std::vector<double>& r = rows.rows[i];
      if (r.size() != 6) {
        throw FormatError(conjugates.string(), fmt::format("line {}", rows.line[i]),
                          "a row needs x y z of the real and x y z of the simulated point");
      }
      to.emplace_back(r[0], r[1], r[2]);
      from.emplace_back(r[3], r[4], r[5]);
    }
    pair.real_from_target = align(from, to).pose;
  }
  const PairFigures f = compare(target, faces, pair);
  result.tables.push_back(plane_table("Your pair: planes", f, false));
  result.tables.push_back(distance_table("Your pair: distances", f, false));
  result.tables.push_back(histogram_table("Your pair: ranges", {"your pair"}, {&f}));
  result.figures["own_pair"] = json_of(f);
  for (const Check& c : pair_checks("your pair", f)) result.checks.push_back(c);
  result.checks.push_back({"your pair, largest difference of the normalised histograms",
                           f.by_icp.histograms.largest_difference(), kHistogramShare});
  result.pictures += histogram_picture("Your pair", f.by_icp.histograms);
  result.inputs.push_back(real);
  result.inputs.push_back(simulated);
  return true;
}

StudyResult study_verification(const StudyRun& run) {
  StudyResult result;
  result.lead =
      "The miniature of Kim et al. before an ILRIS-3D: our simulator against an independent ray "
      "caster in place of the real scan, and the same procedure on walls of real scans.";
  if (!add_own_pair(run, result)) add_miniature(run, result);
  add_walls(run, result);
  return result;
}

}  // namespace underbrush::studies
