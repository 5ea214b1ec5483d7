#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/markup.hpp"
#include "report/object_lists.hpp"
#include "report/summary_page.hpp"
#include "report/svg_plot.hpp"

namespace underbrush::report {
namespace {

using perception::ObjectList;
using perception::OrientedBox;
using perception::TrackedObject;
using Points = SvgPlot::Points;

constexpr const char* kReferenceColour = "#555555";
constexpr std::array kColours{"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e"};
constexpr size_t kBoxesShown = 6;  // Of each object over the whole time.

const char* colour(size_t k) { return kColours[k % kColours.size()]; }

Points outline(const OrientedBox& box) {
  const Vec3 half = box.size_m / 2;
  Points points;
  for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}, {1, 1}}) {
    const Vec3 p = box.from_box({x * half.x(), y * half.y(), 0});
    points.emplace_back(p.x(), p.y());
  }
  points.emplace_back(NAN, NAN);
  return points;
}

void append(Points& to, const Points& from) { to.insert(to.end(), from.begin(), from.end()); }

/// The boxes of every n-th cycle, and the centres over time.
struct Drawing {
  Points boxes, centres;
};

Drawing drawing_of(const std::vector<ObjectList>& lists) {
  Drawing out;
  const size_t step = std::max<size_t>(1, lists.size() / kBoxesShown);
  for (size_t k = 0; k < lists.size(); ++k) {
    for (const TrackedObject& o : lists[k].objects) {
      if (k % step == 0) append(out.boxes, outline(o.box));
      out.centres.emplace_back(o.box.centre_m.x(), o.box.centre_m.y());
    }
  }
  return out;
}

// The place of the objects, with the same scale along both axes.
void set_axes(SvgPlot& plot, const std::vector<Drawing>& drawings) {
  double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
  for (const Drawing& d : drawings) {
    for (const auto& [x, y] : d.centres) {
      low_x = std::min(low_x, x);
      high_x = std::max(high_x, x);
      low_y = std::min(low_y, y);
      high_y = std::max(high_y, y);
    }
  }
  if (low_x > high_x) low_x = high_x = low_y = high_y = 0;
  const double half = std::max({high_x - low_x, (high_y - low_y) * 1.6, 10.0}) / 2 + 5;
  const double x = (low_x + high_x) / 2, y = (low_y + high_y) / 2;
  plot.x_axis(x - half, x + half);
  plot.y_axis(y - half / 1.6, y + half / 1.6);
}

std::string seen_from_above(const NamedLists& reference, std::span<const NamedLists> lists) {
  SvgPlot plot("Boxes and centres over time, seen from above", "x, m", "y, m");
  std::vector<Drawing> drawings{drawing_of(reference.lists)};
  set_axes(plot, drawings);
  for (const NamedLists& l : lists) drawings.push_back(drawing_of(l.lists));
  plot.line(drawings[0].boxes, kReferenceColour, true);
  plot.dots(drawings[0].centres, kReferenceColour, 2);
  for (size_t k = 1; k < drawings.size(); ++k) {
    plot.line(drawings[k].boxes, colour(k - 1));
    plot.dots(drawings[k].centres, colour(k - 1), 2);
  }
  return plot.svg();
}

std::string existence_plot(uint64_t id, const std::vector<perception::ListScore>& scores) {
  SvgPlot plot(fmt::format("Existence of object {}", id), "time, s", "probability");
  plot.y_axis(0, 1.05);
  double begin = 1e300, end = -1e300;
  for (size_t k = 0; k < scores.size(); ++k) {
    for (const auto& followed : scores[k].followed) {
      if (followed.id != id) continue;
      Points points;
      for (const auto& m : followed.moments) {
        points.emplace_back(m.time_s, m.found ? m.found->existence : 0);
        begin = std::min(begin, m.time_s);
        end = std::max(end, m.time_s);
      }
      for (auto& p : points) p.first -= begin;
      plot.line(points, colour(k));
    }
  }
  plot.x_axis(0, std::max(end - begin, 0.1));
  return plot.svg();
}

}  // namespace

std::string list_pictures(const NamedLists& reference, std::span<const NamedLists> lists) {
  std::string html = fmt::format("<p><span style=\"color:{}\">- - {}</span>", kReferenceColour,
                                 escaped(reference.name));
  std::vector<perception::ListScore> scores;
  for (size_t k = 0; k < lists.size(); ++k) {
    html += fmt::format(" <span style=\"color:{}\">— {}</span>", colour(k), escaped(lists[k].name));
    scores.push_back(perception::score_lists(lists[k].lists, reference.lists));
  }
  html += "</p>\n" + seen_from_above(reference, lists);
  if (scores.empty()) return html;
  for (const auto& followed : scores[0].followed) html += existence_plot(followed.id, scores);
  return html;
}

std::filesystem::path write_list_report(const std::filesystem::path& folder,
                                        const std::string& title, const NamedLists& reference,
                                        std::span<const NamedLists> lists,
                                        std::span<const Table> tables,
                                        const std::string& provenance) {
  std::string body = list_pictures(reference, lists);
  for (const Table& table : tables) body += html_of(table);
  SummaryPage page;
  page.title = title;
  page.lead = "Lists of objects against " + reference.name + ".";
  page.verdict = fmt::format("{} lists are shown", lists.size());
  page.body = body;
  page.provenance = provenance;
  return write_summary_page(folder, page);
}

}  // namespace underbrush::report
