#include "report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "report/page.hpp"
#include "report/survey.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::report {
namespace fs = std::filesystem;
namespace {

// A comparison in the making: its id in the page and the level of the headings within it.
struct Section {
  const Comparison& input;
  const Survey& survey;
  std::string id;
  int level = 2;
};

// A heading that the table of contents leads to.
std::string heading(const Section& section, const std::string& text) {
  std::string name;
  for (char c : text) name += c == ' ' ? '-' : char(std::tolower(c));
  return fmt::format("<h{0} id=\"{1}-{2}\">{3}</h{0}>\n", section.level, section.id, name, text);
}

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

// The colours follow the root of the value, so a label stands at their middle too.
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

std::string from_above(const Section& section) {
  const Comparison& input = section.input;
  const Survey& s = section.survey;
  std::string html = heading(section, "From above") + "<div class=\"pictures\">\n";
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
  html += heading(section, "Range error from above") + "<div class=\"pictures\">\n";
  for (size_t k = 0; k < input.simulated.size(); ++k) {
    html += top_figure(s.by_error[k], s, input.simulated[k].name, false);
  }
  return html + "</div>\n" + kErrorLegend +
         "<p class=\"caption\">Simulated points, coloured by the range error of their beam: blue "
         "too "
         "near, red too far. A false hit has no real point; a false miss is drawn at its real "
         "point.</p>\n";
}

std::string one_scan(const Section& section) {
  const Comparison& input = section.input;
  const Survey& s = section.survey;
  const ScanLayout layout = layout_of(s.scan_beams);
  if (layout.beam.empty()) return "";
  std::string html = heading(section, "One scan") + "<div class=\"scroll strips\">\n";
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

// The place of the curve; nothing where no simulation was scored with its model.
std::string reliability_section(const Comparison& input, const Section& section) {
  const bool any = std::any_of(input.simulated.begin(), input.simulated.end(), [&](const auto& m) {
    return input.scores.at("models").at(m.name).contains("reliability");
  });
  if (!any) return "";
  return "<section class=\"script\">\n" + heading(section, "Reliability") +
         "<div class=\"reliability plot\"></div>\n</section>\n";
}

// What the script draws from: scores and points.
Json data_of(const Survey& s, const Comparison& input) {
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
                      {"reliability", scores.value("reliability", Json::object())},
                      {"histogram", scores.value("range_error_histogram", Json::object())}});
  }
  return {{"models", models},
          {"clouds", clouds},
          {"box_m", s.box_m},
          {"floor_m", s.floor_m()},
          {"height_m", s.high_m - s.low_m}};
}

std::string view_caption(const Survey& s) {
  size_t most = 0;
  for (const ViewPoints& p : s.points) most = std::max(most, p.error.size());
  return fmt::format(
      "{:.0f} m × {:.0f} m {}; a sample of the beams, thinner near the sensor and the same for "
      "all, "
      "at most {} points a cloud.",
      s.box_m, s.box_m,
      s.box_holds_all ? "with all but the outermost points"
                      : "around the sensor in the middle of the log",
      grouped(most));
}

std::string lead_of(const Section& section) {
  return fmt::format("{}: {} beams, {} of them hits",
                     escaped(section.input.real.filename().string()), grouped(section.survey.beams),
                     grouped(section.survey.hits));
}

std::string note_of(const Comparison& input) {
  return input.note.empty() ? "" : "<p class=\"note\">" + escaped(input.note) + "</p>";
}

// Stands above the scores of a comparison that has a title.
std::string section_header(const Section& section) {
  if (section.input.title.empty()) return "";
  return fmt::format("<header>\n<h2>{}</h2>\n<p class=\"lead\">{}</p>\n{}\n</header>\n",
                     escaped(section.input.title), lead_of(section), note_of(section.input));
}

std::string html_of(const Section& section) {
  const Comparison& input = section.input;
  const Survey& s = section.survey;
  return filled_section({
      {"id", section.id},
      {"section-header", section_header(section)},
      {"headline", headline_table(input)},
      {"pictures", from_above(section)},
      {"scan", one_scan(section)},
      {"view-heading", heading(section, "In three dimensions")},
      {"confusion-heading", heading(section, "Hits and misses")},
      {"confusion", confusion_tables(input)},
      {"histogram-heading", heading(section, "Range error")},
      {"bands-heading", heading(section, "By range")},
      {"reliability", reliability_section(input, section)},
      {"classes", class_table(input, heading(section, "By class"))},
      {"view-caption", view_caption(s)},
      {"height-legend", scale_legend(s.low_m, s.high_m, "height (z)", "")},
      {"error-legend", kErrorLegend},
      {"provenance", provenance_text(input)},
  });
}

// An entry of the table of contents: the comparison and the headings in its HTML.
std::string contents_entry(const Section& section, const std::string& html) {
  std::string links;
  const std::string begin = fmt::format("<h{} id=\"", section.level);
  for (size_t at = 0; (at = html.find(begin, at)) != std::string::npos;) {
    const size_t id = at + begin.size(), id_end = html.find('"', id);
    const size_t text = id_end + 2, text_end = html.find("</h", text);
    links += fmt::format(" <a href=\"#{}\">{}</a>", html.substr(id, id_end - id),
                         html.substr(text, text_end - text));
    at = text_end;
  }
  return fmt::format("<li><a href=\"#{}\">{}</a><span class=\"script\">{}</span></li>\n",
                     section.id, escaped(section.input.title), links);
}

// JSON that cannot end its script element.
std::string embedded(const Json& data) {
  std::string text = io::text_of_json(data);
  for (size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) {
    text.insert(at + 1, "\\");
  }
  return text;
}

}  // namespace

void check_report_output(const fs::path& folder) {
  std::error_code error;
  fs::path there = folder;
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  try {
    io::check_output((there.empty() ? "." : there) / "index.html");
  } catch (const IoError& e) {
    const std::string what = e.what();
    throw IoError(folder.string() + what.substr(what.find(": cannot write")));
  }
}

fs::path write_report(const fs::path& folder, const ReportInput& input) {
  require(!input.comparisons.empty(), "report: nothing to compare");
  for (const Comparison& c : input.comparisons) {
    for (const auto& m : c.simulated) {
      require(c.scores.contains("models") && c.scores["models"].contains(m.name),
              "report: a simulated log has no scores");
    }
  }
  std::string lead = escaped(input.lead), note, contents, sections;
  Json data = Json::array();
  for (const Comparison& c : input.comparisons) {
    const Survey s = survey(c);
    const std::string id = fmt::format("part-{}", data.size() + 1);
    const Section section{c, s, id, c.title.empty() ? 2 : 3};
    const std::string html = html_of(section);
    if (lead.empty()) lead = lead_of(section);
    if (c.title.empty()) note += note_of(c);
    contents += contents_entry(section, html);
    sections += html;
    data.push_back(data_of(s, c));
  }
  if (input.comparisons.size() > 1) {
    note += "<nav aria-label=\"Contents\"><ol>\n" + contents + "</ol></nav>";
  }
  return write_page(folder, filled_page({{"title", escaped(input.title)},
                                         {"lead", lead},
                                         {"note", note},
                                         {"sections", sections},
                                         {"data", embedded(data)}}));
}

ReportInput page_of_scores(Json scores, const std::filesystem::path& real,
                           std::vector<Comparison::Simulated> simulated) {
  return {"Simulated against real: " + real.filename().string(),
          "",
          {{"", "", std::move(scores), real, std::move(simulated)}}};
}

}  // namespace underbrush::report
