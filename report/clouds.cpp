#include "report/clouds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "report/summary_page.hpp"
#include "report/svg_plot.hpp"

namespace underbrush::report {
namespace {

using metrics::CloudRegion;
using metrics::CloudScores;
using metrics::LengthDistribution;
using metrics::NamedCloudScores;

constexpr size_t kShownRegions = 8;

std::string number(double x, int digits) {
  return std::isfinite(x) ? fmt::format("{:.{}f}", x, digits) : "–";
}

std::string returns_of(const CloudScores& s, size_t side) {
  const auto& r = s.returns[side];
  return fmt::format("{:.3f} / {:.3f} / {:.3f} / {:.3f}", r[0], r[1], r[2], r[3]);
}

Table table_of_scores(const std::vector<NamedCloudScores>& clouds) {
  Table t{"Point clouds",
          "Beams are not paired. Distances are those of nearest points. Cells are of 0.25 "
          "m; heights are those above the lowest real point within 2 m squares.",
          {"", "real"},
          {}};
  for (const NamedCloudScores& c : clouds) t.head.push_back(c.name);
  const auto row = [&](const std::string& name, const std::string& real, const auto& value) {
    std::vector<std::string>& cells = t.rows.emplace_back(std::vector{name, real});
    for (const NamedCloudScores& c : clouds) cells.push_back(value(c.scores));
  };
  const CloudScores& first = clouds[0].scores;
  using S = const CloudScores&;
  row("points", std::to_string(first.points[0]), [](S s) { return std::to_string(s.points[1]); });
  row("beams with 0 / 1 / 2 / more returns", returns_of(first, 0),
      [](S s) { return returns_of(s, 1); });
  row("cloud error, m", "", [](S s) { return number(s.cloud_error_m, 4); });
  row("real point to simulated cloud, m", "", [](S s) { return number(s.nearest_m[0], 4); });
  row("simulated point to real cloud, m", "", [](S s) { return number(s.nearest_m[1], 4); });
  row("density-aware Chamfer", "", [](S s) { return number(s.density_aware_chamfer, 4); });
  row("cells of both / of either", "", [](S s) { return number(s.occupied, 3); });
  row("distance of ranges, m", "", [](S s) { return number(s.range.distance_m, 3); });
  row("distance of heights, m", "", [](S s) { return number(s.height.distance_m, 3); });
  return t;
}

/// The regions with the greatest shares of the error.
Table table_of_regions(const std::string& name, const CloudScores& s) {
  std::vector<CloudRegion> order = s.regions;
  std::stable_sort(order.begin(), order.end(), [](const CloudRegion& a, const CloudRegion& b) {
    return a.error_share > b.error_share;
  });
  const size_t shown = std::min(order.size(), kShownRegions);
  Table t{
      fmt::format("Where {} errs: {} of {} regions", name, shown, order.size()),
      "Regions are squares of 20 m, those with the greatest share of the error first.",
      {"x, y from, m", "real points", "simulated", "cloud error, m", "share of it", "heights, m"},
      {}};
  for (size_t k = 0; k < shown; ++k) {
    const CloudRegion& r = order[k];
    t.rows.push_back({fmt::format("{:.0f}, {:.0f}", CloudScores::kRegionM * r.at.x,
                                  CloudScores::kRegionM * r.at.y),
                      std::to_string(r.points[0]), std::to_string(r.points[1]),
                      number(r.cloud_error_m, 3), number(r.error_share, 3),
                      number(r.height_distance_m, 3)});
  }
  return t;
}

std::string plot_of(const std::string& title, const std::string& of,
                    const std::vector<NamedCloudScores>& clouds,
                    LengthDistribution CloudScores::*length) {
  struct Colour {
    const char *code, *name;
  };
  static constexpr std::array<Colour, 5> kColours{{{"#d95f02", "orange"},
                                                   {"#1b9e77", "green"},
                                                   {"#7570b3", "violet"},
                                                   {"#e7298a", "pink"},
                                                   {"#888888", "grey"}}};
  SvgPlot plot(title, of, "share of the points");
  double low = HUGE_VAL, high = -HUGE_VAL, top = 0;
  const auto line = [&](const LengthDistribution& d, size_t side, const std::string& colour) {
    SvgPlot::Points points;
    for (size_t k = 0; k < d.share[side].size(); ++k) {
      const double at = d.first_m + (double(k) + 0.5) * d.bin_m;
      points.emplace_back(at, d.share[side][k]);
      low = std::min(low, at);
      high = std::max(high, at);
      top = std::max(top, d.share[side][k]);
    }
    return std::pair{points, colour};
  };
  std::vector<std::pair<SvgPlot::Points, std::string>> lines{
      line(clouds[0].scores.*length, 0, "#000")};
  for (size_t k = 0; k < clouds.size(); ++k) {
    lines.push_back(line(clouds[k].scores.*length, 1, kColours[k % kColours.size()].code));
  }
  if (!(low < high)) return "";
  plot.x_axis(low, high);
  plot.y_axis(0, 1.05 * top);
  for (const auto& [points, colour] : lines) plot.line(points, colour);
  std::string legend = "black: real";
  for (size_t k = 0; k < clouds.size(); ++k) {
    legend += fmt::format("; {}: {}", kColours[k % kColours.size()].name, clouds[k].name);
  }
  plot.text(low + 0.3 * (high - low), top, legend);
  return plot.svg();
}

}  // namespace

std::vector<Table> tables_of_clouds(const std::vector<NamedCloudScores>& clouds) {
  std::vector<Table> out{table_of_scores(clouds)};
  for (const NamedCloudScores& c : clouds) out.push_back(table_of_regions(c.name, c.scores));
  return out;
}

std::filesystem::path write_cloud_report(const std::filesystem::path& folder,
                                         const std::vector<NamedCloudScores>& clouds,
                                         const std::string& provenance) {
  std::string body;
  for (const Table& table : tables_of_clouds(clouds)) body += html_of(table);
  body += plot_of("Ranges", "range, m", clouds, &CloudScores::range) +
          plot_of("Heights", "height above the lowest real point, m", clouds, &CloudScores::height);
  return write_summary_page(
      folder,
      {"Point clouds compared", "The logs share no beams, so their point clouds are compared.",
       fmt::format("cloud error {} m", number(clouds[0].scores.cloud_error_m, 4)), "", body,
       provenance});
}

}  // namespace underbrush::report
