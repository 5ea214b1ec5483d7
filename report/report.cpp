#include "report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/page.hpp"
#include "report/survey.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::report {
namespace fs = std::filesystem;
namespace {

// The longest 1, 2 or 5 times a power of ten within a quarter of the picture.
double scale_bar_m(const TopView& view) {
  return round_step_below(view.width * view.metres_per_pixel / 4);
}

std::string top_figure(const io::Image& image, const Survey& s, const std::string& name,
                       bool holds_real) {
  const double bar = scale_bar_m(s.view);
  return fmt::format(
      "<figure><div class=\"scaled\"><img src=\"{}\" alt=\"{} from above\"{}>"
      "<span class=\"bar\" style=\"width:{:.2f}%\">{} m</span></div>"
      "<figcaption>{}</figcaption></figure>\n",
      data_url(image), escaped(name), holds_real ? " class=\"holds-real\"" : "",
      100 * bar / (s.view.width * s.view.metres_per_pixel), bar, escaped(name));
}

std::string metres(double x) {
  const std::string text = fmt::format("{:.1f}", std::abs(x));
  return (x < 0 && text != "0.0" ? "−" : "") + text;
}

// The colours go with the root of the value, so a label stands at their middle too.
std::string scale_legend(double low, double high, const char* what, const char* more) {
  return fmt::format(
      "<p class=\"legend\"><span>{}</span><span class=\"ramp scale\">"
      "<b>{}</b><b>{}</b><b>{} m</b></span>{}</p>\n",
      what, metres(low), metres(low + 0.25 * (high - low)), metres(high), more);
}

constexpr const char* kErrorLegend =
    "<p class=\"legend\"><span>simulated − measured range</span><span class=\"ramp errors\">"
    "<b>−1</b><b>0</b><b>+1 m</b></span><span class=\"key false-hit\">false hit</span>"
    "<span class=\"key false-miss\">false miss</span></p>\n";

std::string from_above(const Survey& s, const ReportInput& input) {
  std::string html = "<h2>From above</h2>\n<div class=\"pictures\">\n";
  html += top_figure(s.by_height[0], s, "real", false);
  for (size_t k = 0; k < input.simulated.size(); ++k) {
    html += top_figure(s.by_height[k + 1], s, input.simulated[k].name, true);
  }
  html += "</div>\n" + scale_legend(s.low_m, s.high_m, "height (z)", "");
  html += fmt::format(
      "<p class=\"caption\">All {} beams; of the points on one pixel ({:.2f} m) the highest is "
      "shown, and gaps of a pixel are closed. The same view for all: 98 % of the real points along "
      "each axis."
      "<span class=\"script\"> Press a simulated picture and hold to see the real "
      "one.</span></p>\n",
      grouped(s.beams), s.view.metres_per_pixel);
  html += "<h2>Range error from above</h2>\n<div class=\"pictures\">\n";
  for (size_t k = 0; k < input.simulated.size(); ++k) {
    html += top_figure(s.by_error[k], s, input.simulated[k].name, false);
  }
  return html + "</div>\n" + kErrorLegend +
         "<p class=\"caption\">Simulated points, coloured by the range error of their beam: blue "
         "too "
         "near, red too far. A false hit has no real point; a false miss is drawn at its real "
         "point.</p>\n";
}

std::string one_scan(const Survey& s, const ReportInput& input) {
  const ScanLayout layout = layout_of(s.scan_beams);
  if (layout.beam.empty()) return "";
  std::string html = "<h2>One scan</h2>\n<div class=\"scroll strips\">\n";
  const auto add = [&](const io::Image& image, const std::string& name) {
    html += fmt::format(
        "<figure><figcaption><span>{}</span></figcaption><img src=\"{}\" alt=\"range image: {}\">"
        "</figure>\n",
        escaped(name), data_url(image), escaped(name));
  };
  add(range_image(s.scan_beams, layout, -1, s.far_m), "real");
  for (size_t k = 0; k < input.simulated.size(); ++k) {
    add(range_image(s.scan_beams, layout, int(k), s.far_m), input.simulated[k].name);
    add(error_image(s.scan_beams, layout, int(k)), input.simulated[k].name + ", range error");
  }
  html += "</div>\n" +
          scale_legend(0, s.far_m, "range", "<span class=\"key miss\">no return</span>") +
          kErrorLegend;
  html += fmt::format(
      "<p class=\"caption\">Scan {}, in the middle of the log: {} beams; {} by azimuth (left to "
      "right as seen from the sensor{}). Where beams share a pixel, the first is shown.</p>\n",
      s.scan, grouped(s.scan_beams.size()),
      layout.by_ring ? fmt::format("{} rings, highest on top,", layout.rows) : "elevation",
      s.scan_in_sensor_frame ? "" : "; world axes, as the log gives no pose");
  return html;
}

// What the script draws from: scores and points.
Json data_of(const Survey& s, const ReportInput& input) {
  Json clouds = Json::array();
  for (size_t k = 0; k < s.points.size(); ++k) {
    const ViewPoints& p = s.points[k];
    Json cloud = {{"name", k ? input.simulated[k - 1].name : "real"},
                  {"xyz", base64(p.xyz.data(), p.xyz.size() * sizeof(uint16_t))}};
    if (k) cloud["error"] = base64(p.error.data(), p.error.size());
    clouds.push_back(std::move(cloud));
  }
  Json models = Json::array();
  for (const auto& m : input.simulated) {
    Json scores = input.scores.at("models").at(m.name);
    models.push_back({{"name", m.name},
                      {"per_range", scores.value("per_range", Json::object())},
                      {"histogram", scores.value("range_error_histogram", Json::object())}});
  }
  return {{"models", models},
          {"clouds", clouds},
          {"box_m", s.box_m},
          {"floor_m", kBelowLow},
          {"height_m", s.high_m - s.low_m}};
}

std::string view_caption(const Survey& s) {
  size_t most = 0;
  for (const ViewPoints& p : s.points) most = std::max(most, p.error.size());
  return fmt::format(
      "{:.0f} m × {:.0f} m around the sensor in the middle of the log; a sample of the beams, "
      "thinner near "
      "the sensor and the same for all, at most {} points a cloud.",
      s.box_m, s.box_m, grouped(most));
}

}  // namespace

void check_report_output(fs::path folder) {
  while (!fs::exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
  io::check_output((folder.empty() ? "." : folder) / "index.html");
}

fs::path write_report(const fs::path& folder, const ReportInput& input) {
  for (const auto& m : input.simulated) {
    require(input.scores.contains("models") && input.scores["models"].contains(m.name),
            "report: a simulated log has no scores");
  }
  const Survey s = survey(input);
  const std::string note =
      input.note.empty() ? "" : "<p class=\"note\">" + escaped(input.note) + "</p>";
  std::string data = data_of(s, input).dump(-1, ' ', false, Json::error_handler_t::replace);
  for (size_t at = 0; (at = data.find("</", at)) != std::string::npos; at += 3) {
    data.insert(at + 1, "\\");  // would end the script element
  }
  const std::string page = filled_page({
      {"title", escaped(input.title)},
      {"note", note},
      {"lead", fmt::format("{}: {} beams, {} of them hits", escaped(input.real.filename().string()),
                           grouped(s.beams), grouped(s.hits))},
      {"headline", headline_table(input)},
      {"pictures", from_above(s, input)},
      {"scan", one_scan(s, input)},
      {"confusion", confusion_tables(input)},
      {"classes", class_table(input)},
      {"view-caption", view_caption(s)},
      {"height-legend", scale_legend(s.low_m, s.high_m, "height (z)", "")},
      {"error-legend", kErrorLegend},
      {"provenance", provenance_text(input)},
      {"data", data},
  });
  return write_page(folder, page);
}

}  // namespace underbrush::report
