#include "studies/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "leaf_cloud.hpp"
#include "report/svg_plot.hpp"
#include "studies/studies.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/io/table.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::studies {
namespace fs = std::filesystem;
namespace {

constexpr double kMeanDistanceM = 0.0031, kHistogramShare = 0.001;

/// Values of [kim12] tables 3 and 4.
struct PublishedPlanes {
  double a, b, c, variance, simulated, simulated_sigma, real, real_sigma;
};
constexpr PublishedPlanes kPublished[] = {
    {-0.0068, 0.1758, -4.6609, 0.000007, 0.0033, 0.0023, 0.0020, 0.0016},
    {-5.2942, -5.3171, 127.8994, 0.003285, 0.0013, 0.0009, 0.0060, 0.0047},
    {5.3384, -5.0953, 118.0402, 0.002470, 0.0017, 0.0016, 0.0053, 0.0041},
    {0.0043, 0.1966, -5.9813, 0.000015, 0.0006, 0.0004, 0.0028, 0.0025},
    {-3.0086, -3.0343, 71.5532, 0.001084, 0.0043, 0.0026, 0.0060, 0.0044},
    {3.3045, -3.2052, 77.4906, 0.001131, 0.0035, 0.0022, 0.0058, 0.0041},
    {-0.0089, 0.1785, -5.5369, 0.000010, 0.0050, 0.0006, 0.0023, 0.0021},
    {-2.8331, -2.9453, 73.5125, 0.001153, 0.0051, 0.0034, 0.0067, 0.0045},
    {3.9314, -3.6851, 83.8237, 0.000693, 0.0032, 0.0022, 0.0039, 0.0028}};

std::string millimetres(double m) { return fmt::format("{:.1f}", 1e3 * m); }

report::Table plane_table(const std::string& title, const PairFigures& f, bool published) {
  report::Table table{
      title,
      "z = a x + b y + c of the real cloud, x to the right, y forward, z up, by least "
      "squares with errors in z alone; σ̂₀² in m². b⊥: the same slope from the "
      "perpendicular fit, which the distances are taken from; σ of the perpendicular "
      "distances in mm.",
      {"patch", "a", "b", "c", "σ̂₀²", "σ_a", "σ_b", "σ_c", "b⊥", "σ⊥"},
      {}};
  for (size_t k = 0; k < f.patches.size(); ++k) {
    const PatchFigures& p = f.patches[k];
    const Vec3 x = p.height.parameters, s = p.height.covariance.diagonal().cwiseSqrt();
    table.rows.push_back({fmt::format("{}", k + 1), fmt::format("{:.4f}", x[0]),
                          fmt::format("{:.4f}", x[1]), fmt::format("{:.4f}", x[2]),
                          fmt::format("{:.6f}", p.height.variance), fmt::format("{:.4f}", s[0]),
                          fmt::format("{:.4f}", s[1]), fmt::format("{:.3f}", s[2]),
                          fmt::format("{:.3f}", -p.plane.normal.x() / p.plane.normal.z()),
                          millimetres(std::sqrt(p.plane.variance))});
    if (!published) continue;
    const PublishedPlanes& q = kPublished[k];
    table.rows.push_back({fmt::format("{} published", k + 1), fmt::format("{:.4f}", q.a),
                          fmt::format("{:.4f}", q.b), fmt::format("{:.4f}", q.c),
                          fmt::format("{:.6f}", q.variance), "", "", "", "", ""});
  }
  return table;
}

report::Table distance_table(const std::string& title, const PairFigures& f, bool published) {
  report::Table table{title,
                      "Absolute distance from the planes of the real cloud, mean ± standard "
                      "deviation, mm; offset: mean of the signed distance of the simulated points.",
                      {"patch", "real points", "simulated points", "simulated", "offset", "real"},
                      {}};
  if (published) table.head.insert(table.head.end(), {"published simulated", "published real"});
  const auto both = [](double mean, double sigma) {
    return fmt::format("{:.1f} ± {:.1f}", 1e3 * mean, 1e3 * sigma);
  };
  for (size_t k = 0; k < f.patches.size(); ++k) {
    const PatchFigures& p = f.patches[k];
    table.rows.push_back(
        {fmt::format("{}", k + 1), fmt::format("{}", p.real.points),
         fmt::format("{}", p.simulated.points), both(p.simulated.mean_m, p.simulated.sigma_m),
         fmt::format("{:+.2f}", 1e3 * p.simulated.offset_m), both(p.real.mean_m, p.real.sigma_m)});
    if (!published) continue;
    const PublishedPlanes& q = kPublished[k];
    table.rows.back().push_back(both(q.simulated, q.simulated_sigma));
    table.rows.back().push_back(both(q.real, q.real_sigma));
  }
  table.rows.push_back({"mean", "", "", fmt::format("{:.2f}", 1e3 * f.mean_distance_m()), "",
                        fmt::format("{:.2f}", 1e3 * f.real_mean_distance_m())});
  if (published) table.rows.back().insert(table.rows.back().end(), {"3.1", "4.5"});
  return table;
}

report::Table histogram_table(const std::string& title, const std::vector<std::string>& names,
                              const std::vector<const PairFigures*>& all) {
  report::Table table{
      title,
      "Ranges in intervals of 5 cm, real against simulated after co-registration. "
      ""
      "Published: counts differ by about 100 an interval, shares by about 0.1 %. Real "
      "against real: the instrument against itself with its raster shifted, the least "
      "that so many scans can show.",
      {"clouds", "real points", "simulated points", "mean |Δcount|", "mean |Δshare|",
       "largest |Δshare|", "ICP, steps", "corners", "corners − ICP, mm"},
      {}};
  for (size_t k = 0; k < all.size(); ++k) {
    const PairFigures& f = *all[k];
    table.rows.push_back(
        {names[k], fmt::format("{}", f.real_points), fmt::format("{}", f.simulated_points),
         fmt::format("{:.1f}", f.histograms.mean_count_difference()),
         fmt::format("{:.3f} %", 100 * f.histograms.mean_difference()),
         fmt::format("{:.3f} %", 100 * f.histograms.largest_difference()),
         fmt::format("{}", f.icp.iterations), fmt::format("{}", f.conjugate_real.size()),
         millimetres(f.corners_against_icp_m)});
  }
  return table;
}

Json json_of(const PairFigures& f) {
  Json patches = Json::array();
  for (const PatchFigures& p : f.patches) {
    const Vec3& x = p.height.parameters;
    patches.push_back({{"plane", {x[0], x[1], x[2]}},
                       {"variance_m2", p.height.variance},
                       {"simulated_m", p.simulated.mean_m},
                       {"simulated_sigma_m", p.simulated.sigma_m},
                       {"simulated_offset_m", p.simulated.offset_m},
                       {"real_m", p.real.mean_m},
                       {"real_sigma_m", p.real.sigma_m},
                       {"real_points", p.real.points},
                       {"simulated_points", p.simulated.points}});
  }
  return {{"patches", patches},
          {"mean_patch_distance_m", f.mean_distance_m()},
          {"real_mean_patch_distance_m", f.real_mean_distance_m()},
          {"real_points", f.real_points},
          {"simulated_points", f.simulated_points},
          {"histogram_largest_share_difference", f.histograms.largest_difference()},
          {"histogram_mean_share_difference", f.histograms.mean_difference()},
          {"histogram_mean_count_difference", f.histograms.mean_count_difference()},
          {"corners", f.conjugate_real.size()},
          {"corners_rms_m", f.conjugate_rms_m},
          {"corners_against_icp_m", f.corners_against_icp_m},
          {"icp_rms_m", f.icp.rms_m},
          {"icp_converged", f.icp.converged}};
}

/// Returns the point file whose name without extension is `stem`, or none.
fs::path cloud_file(const fs::path& folder, const std::string& stem) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().stem() == stem && io::is_table_file(entry.path())) return entry.path();
  }
  return {};
}

}  // namespace

std::vector<Check> pair_checks(const std::string& what, const PairFigures& figures) {
  return {{what + ", mean distance of the patches (m)", figures.mean_distance_m(), kMeanDistanceM},
          {what + ", largest difference of the normalised histograms",
           figures.histograms.largest_difference(), kHistogramShare}};
}

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
  std::vector<Vec3> again;  // A second scan by the same instrument, with its raster shifted
                            // differently.
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
  const PairFigures all_again =
      compare(target, miniature_patches(), {std::move(pair.real), std::move(again), guess});
  const bool nine = one.patches.size() == std::size(kPublished);
  result.tables.push_back(plane_table("Planes of the real cloud (Table 3)", one, nine));
  result.tables.push_back(distance_table("Distances from the planes (Table 4)", one, nine));
  const std::string many = fmt::format("{} scans", scans);
  result.tables.push_back(histogram_table(
      "Range histograms (Fig. 7)",
      {"one scan", "one scan, real against real", many, many + ", real against real"},
      {&one, &one_again, &all, &all_again}));
  result.figures["miniature"] = json_of(one);
  result.figures["miniature_again"] = json_of(one_again);
  result.figures["miniature_scans"] = json_of(all);
  result.figures["miniature_scans_again"] = json_of(all_again);
  result.figures["miniature_scans"]["scans"] = scans;
  result.checks.push_back({"patches seen", double(one.patches.size()), 9, false});
  result.checks.push_back(pair_checks("one scan", one)[0]);
  result.checks.push_back({"one scan, mean difference of the normalised histograms",
                           one.histograms.mean_difference(), kHistogramShare});
  result.checks.push_back(pair_checks(many, all)[1]);
  result.pictures += histogram_picture("One scan", one.histograms);
  result.pictures += histogram_picture(many, all.histograms);
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
  CloudPair pair{app::points_of(real), app::points_of(simulated), {}};
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
  result.pictures += histogram_picture("Your pair", f.histograms);
  result.inputs.push_back(real);
  result.inputs.push_back(simulated);
  return true;
}

std::string histogram_picture(const std::string& title, const RangeHistograms& h) {
  double most = 0;
  report::SvgPlot::Points real, simulated;
  for (size_t k = 0; k < h.a.count.size(); ++k) {
    for (const double side : {0.0, 1.0}) {
      const double x = h.a.first_m + (double(k) + side) * h.a.bin_m;
      real.emplace_back(x, 100 * h.a.share(k));
      simulated.emplace_back(x, 100 * h.b.share(k));
    }
    most = std::max({most, 100 * h.a.share(k), 100 * h.b.share(k)});
  }
  report::SvgPlot plot(
      title + fmt::format(": real ({} points) red, simulated ({}) blue", h.a.total(), h.b.total()),
      "range, m", "share of points, %");
  plot.x_axis(h.a.first_m, h.a.first_m + double(h.a.count.size()) * h.a.bin_m);
  plot.y_axis(0, 1.1 * most);
  plot.line(real, "#c33");
  plot.line(simulated, "#27c", true);
  return plot.svg();
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
