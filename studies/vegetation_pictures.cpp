#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/page.hpp"
#include "report/pictures.hpp"
#include "studies/vegetation.hpp"
#include "report/svg_plot.hpp"

namespace underbrush::studies {
namespace {

using metrics::BearingRangeHistogram;
using Bin = BearingRangeHistogram::Bin;

constexpr double kWindowM = 0.6;         // of range, as [deschaud12] Fig. 6
constexpr int kTall = 5, kMissWide = 8;  // pixels of a bearing, of the no-return bin
constexpr const char* kColours[] = {"#c33", "#27c", "#c80", "#2a2"};

/// What of the histograms is shown: one laser, its bearings, a window of range.
struct Window {
  uint16_t ring = 0;
  std::vector<uint16_t> bearings;  ///< Left to right.
  uint32_t first = 0, ranges = 1;  ///< Range bins.
};

/// The middle laser; the window about the median range.
Window window_of(const BearingRangeHistogram& real) {
  Window w;
  std::vector<uint16_t> rings;
  for (const Bin& bin : real.occupied()) {
    if (rings.empty() || rings.back() != bin.ring) rings.push_back(bin.ring);
  }
  w.ring = rings[rings.size() / 2];
  std::map<uint32_t, uint64_t> by_range;
  uint64_t hits = 0;
  for (const Bin& bin : real.occupied()) {
    if (bin.ring != w.ring) continue;
    if (w.bearings.empty() || w.bearings.back() != bin.bearing) w.bearings.push_back(bin.bearing);
    if (bin.range != BearingRangeHistogram::kNoReturn)
      by_range[bin.range] += bin.count, hits += bin.count;
  }
  const auto turn = uint16_t(std::lround(2 * M_PI / real.bins().bearing_rad));
  std::sort(w.bearings.begin(), w.bearings.end(), [&](uint16_t a, uint16_t b) {
    return int(a) - (a > turn / 2 ? turn : 0) > int(b) - (b > turn / 2 ? turn : 0);
  });
  w.ranges = uint32_t(kWindowM / real.bins().range_m);
  uint64_t below = 0;
  for (const auto& [range, count] : by_range) {
    if (2 * (below += count) >= hits) {
      w.first = range - std::min(range, w.ranges / 2);
      break;
    }
  }
  return w;
}

/// Shares of the range bins of one direction, the no-return bin last.
std::vector<double> shares(const BearingRangeHistogram& h, const Window& w, uint16_t bearing) {
  std::vector<double> out(w.ranges + 1);
  double sum = 0;
  for (const Bin& bin : h.occupied()) {
    if (bin.ring != w.ring || bin.bearing != bearing) continue;
    sum += bin.count;
    if (bin.range == BearingRangeHistogram::kNoReturn) out.back() += bin.count;
    if (bin.range >= w.first && bin.range - w.first < w.ranges)
      out[bin.range - w.first] += bin.count;
  }
  for (double& s : out) s /= std::max(sum, 1.0);
  return out;
}

/// Bearings from top to bottom, ranges from left to right, then the share without a return.
io::Image picture(const BearingRangeHistogram& h, const Window& w) {
  constexpr double kFull = 0.1;  // share at the end of the colours, which go with its root
  io::Image image(int(w.ranges) + kMissWide, int(w.bearings.size()) * kTall);
  for (size_t b = 0; b < w.bearings.size(); ++b) {
    const std::vector<double> share = shares(h, w, w.bearings[b]);
    for (int x = 0; x < image.width; ++x) {
      const bool miss = x >= int(w.ranges);
      const double s = miss ? share.back() : share[size_t(x)] / kFull;
      const report::Rgb c = s > 0 ? report::scale_colour(std::sqrt(s)) : report::kBackground;
      for (int t = 0; t < kTall; ++t) {
        const size_t at = (b * kTall + size_t(t)) * size_t(image.width) + size_t(x);
        std::copy(c.begin(), c.end(), image.rgb.begin() + std::ptrdiff_t(3 * at));
      }
    }
  }
  return image;
}

std::string plot(const std::string& target, const std::vector<NamedHistogram>& shown,
                 const Window& w) {
  const uint16_t bearing = w.bearings[w.bearings.size() / 2];
  const double step = shown[0].histogram->bins().range_m;
  std::string names;
  std::vector<report::SvgPlot::Points> lines;
  double top = 0.01;
  for (size_t k = 0; k < shown.size(); ++k) {
    const std::vector<double> share = shares(*shown[k].histogram, w, bearing);
    lines.emplace_back();
    for (uint32_t r = 0; r < w.ranges; ++r) {
      lines.back().emplace_back((w.first + r + 0.5) * step, share[r]);
      top = std::max(top, share[r]);
    }
    names += fmt::format("{}{} {:.0f} %", k ? ", " : "", shown[k].name, 100 * share.back());
  }
  report::SvgPlot svg(target + ": one beam", "range, m", "share of the beams a bin of 2 mm");
  svg.x_axis(w.first * step, (w.first + w.ranges) * step);
  svg.y_axis(0, 1.05 * top);
  for (size_t k = 0; k < shown.size(); ++k) {
    const auto at = [&](double share) { return (w.first + share * w.ranges) * step; };
    const double high = (1 - 0.05 * double(k)) * top;
    svg.line(lines[k], kColours[k % std::size(kColours)]);
    svg.line({{at(0.02), high}, {at(0.05), high}}, kColours[k % std::size(kColours)]);
    svg.text(at(0.06), 0.992 * high, shown[k].name);
  }
  return fmt::format("<figure>{}<figcaption>No return: {}</figcaption></figure>\n", svg.svg(),
                     report::escaped(names));
}

}  // namespace

std::string histogram_figures(const std::string& target, const std::vector<NamedHistogram>& shown) {
  const Window w = window_of(*shown.at(0).histogram);
  std::string html = fmt::format("<h2>{}</h2>\n<div class=\"pictures\">\n", report::escaped(target));
  for (const NamedHistogram& n : shown) {
    html += fmt::format(
        "<figure><img src=\"{}\" alt=\"bearing by range: "
        "{}\"><figcaption>{}</figcaption></figure>\n",
        report::data_url(picture(*n.histogram, w)), report::escaped(n.name), report::escaped(n.name));
  }
  return html + "</div>\n" +
         fmt::format(
             "<p class=\"caption\">Laser {}: {} bearings of 0.09° (left on top) by {:.1f} m "
             "of range in bins of 2 mm (far to the right); the strip at the right edge is "
             "the no-return bin.</p>\n",
             w.ring, w.bearings.size(), kWindowM) +
         plot(target, shown, w);
}

}  // namespace underbrush::studies
