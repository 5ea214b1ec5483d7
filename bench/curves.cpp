#include "curves.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "report/svg_plot.hpp"

namespace underbrush::bench {

void plot_curves(const Json& cases, const std::string& key, const std::string& of,
                 const std::string& counted, const std::string& title, const std::string& file) {
  report::SvgPlot out(title + ", HDL-64E beams in firing order (Embree: ordered)",
                      "log10 of the number of " + counted, "million rays/s a core");
  const std::tuple<const char*, const char*, const char*> ways[] = {
      {"ours_avx512", "ours, AVX-512", "#0a7d33"},
      {"ours_avx2", "ours, AVX2", "#4cb86a"},
      {"ours_sse2", "ours, SSE2", "#a9dcb5"},
      {"embree", "Embree's best", "#b3261e"}};
  report::SvgPlot::Points lines[std::size(ways)];
  double most = 0, first = 99, last = 0;
  for (const Json& c : cases) {
    if (c[key] != of || (c.contains("sub_rays") && c["sub_rays"] != 1)) continue;
    const double x = std::log10(c[counted].get<double>());
    first = std::min(first, x);
    last = std::max(last, x);
    for (size_t k = 0; k < std::size(ways); ++k) {
      const double y = 1e-6 * fastest(c["rays_per_s_per_core"], std::get<0>(ways[k]));
      most = std::max(most, 1.1 * y);
      if (y > 0) lines[k].emplace_back(x, y);
    }
  }
  out.x_axis(first, last + 0.7);
  out.y_axis(0, most);
  std::vector<std::pair<double, const char*>> names;  // of the lines, at their ends
  for (size_t k = 0; k < std::size(ways); ++k) {
    if (lines[k].empty()) continue;
    const auto& [prefix, name, colour] = ways[k];
    out.line(lines[k], colour, prefix == std::string("embree"));
    out.dots(lines[k], colour, 6);
    names.emplace_back(lines[k].back().second, name);
  }
  // Names of lines that end together stand one above the other.
  std::sort(names.begin(), names.end());
  double least = 0;
  for (const auto& [y, name] : names) {
    const double at = std::max(y, least);
    out.text(last + 0.04, at, name);
    least = at + 0.045 * most;
  }
  out.write(file);
}

}  // namespace underbrush::bench
