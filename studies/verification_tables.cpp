#include "studies/verification_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/svg_plot.hpp"

namespace underbrush::studies {
namespace {

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

}  // namespace

report::Table plane_table(const std::string& title, const PairFigures& f, bool published) {
  report::Table table{
      title,
      "z = a x + b y + c of the real cloud, x to the right, y forward, z up, by least "
      "squares with errors in z alone; σ̂₀² in m². b⊥: the same slope from the "
      "perpendicular fit, which the distances are taken from; σ of the perpendicular "
      "distances in mm.",
      {"patch", "a", "b", "c", "σ̂₀²", "σ_a", "σ_b", "σ_c", "b⊥", "σ⊥"},
      {}};
  for (size_t k = 0; k < f.by_icp.patches.size(); ++k) {
    const PatchFigures& p = f.by_icp.patches[k];
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
  for (size_t k = 0; k < f.by_icp.patches.size(); ++k) {
    const PatchFigures& p = f.by_icp.patches[k];
    table.rows.push_back(
        {fmt::format("{}", k + 1), fmt::format("{}", p.real.points),
         fmt::format("{}", p.simulated.points), both(p.simulated.mean_m, p.simulated.sigma_m),
         fmt::format("{:+.2f}", 1e3 * p.simulated.offset_m), both(p.real.mean_m, p.real.sigma_m)});
    if (!published) continue;
    const PublishedPlanes& q = kPublished[k];
    table.rows.back().push_back(both(q.simulated, q.simulated_sigma));
    table.rows.back().push_back(both(q.real, q.real_sigma));
  }
  table.rows.push_back({"mean", "", "", fmt::format("{:.2f}", 1e3 * f.by_icp.mean_distance_m()), "",
                        fmt::format("{:.2f}", 1e3 * f.by_icp.real_mean_distance_m())});
  if (published) table.rows.back().insert(table.rows.back().end(), {"3.1", "4.5"});
  return table;
}

report::Table histogram_table(const std::string& title, const std::vector<std::string>& names,
                              const std::vector<const PairFigures*>& all) {
  report::Table table{
      title,
      "Ranges in intervals of 5 cm, real against simulated after co-registration by iterated "
      "closest points or by the corners where three planes meet, as published. Published: counts "
      "differ by about 100 an interval, shares by about 0.1 %. Real "
      "against real: the instrument against itself with its raster shifted, the least "
      "that so many scans can show.",
      {"clouds", "registered by", "real points", "simulated points", "mean distance, mm",
       "mean |Δcount|", "mean |Δshare|", "largest |Δshare|", "registration"},
      {}};
  for (size_t k = 0; k < all.size(); ++k) {
    const PairFigures& f = *all[k];
    for (const Registered* by : {&f.by_icp, &f.by_corners}) {
      const bool icp = by == &f.by_icp;
      table.rows.push_back({names[k], icp ? "ICP" : "corners", fmt::format("{}", f.real_points),
                            fmt::format("{}", f.simulated_points),
                            fmt::format("{:.2f}", 1e3 * by->mean_distance_m()),
                            fmt::format("{:.1f}", by->histograms.mean_count_difference()),
                            fmt::format("{:.3f} %", 100 * by->histograms.mean_difference()),
                            fmt::format("{:.3f} %", 100 * by->histograms.largest_difference()),
                            icp ? fmt::format("{} steps", f.icp.iterations)
                                : fmt::format("{} corners, {} mm from ICP", f.conjugate_real.size(),
                                              millimetres(f.corners_against_icp_m))});
    }
  }
  return table;
}

Json json_of(const PairFigures& f) {
  Json patches = Json::array();
  for (const PatchFigures& p : f.by_icp.patches) {
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
          {"mean_patch_distance_m", f.by_icp.mean_distance_m()},
          {"real_mean_patch_distance_m", f.by_icp.real_mean_distance_m()},
          {"real_points", f.real_points},
          {"simulated_points", f.simulated_points},
          {"histogram_largest_share_difference", f.by_icp.histograms.largest_difference()},
          {"histogram_mean_share_difference", f.by_icp.histograms.mean_difference()},
          {"histogram_mean_count_difference", f.by_icp.histograms.mean_count_difference()},
          {"corners", f.conjugate_real.size()},
          {"mean_patch_distance_by_corners_m", f.by_corners.mean_distance_m()},
          {"histogram_largest_share_difference_by_corners",
           f.by_corners.histograms.largest_difference()},
          {"histogram_mean_share_difference_by_corners", f.by_corners.histograms.mean_difference()},
          {"corners_rms_m", f.conjugate_rms_m},
          {"corners_against_icp_m", f.corners_against_icp_m},
          {"icp_rms_m", f.icp.rms_m},
          {"icp_converged", f.icp.converged}};
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

}  // namespace underbrush::studies
