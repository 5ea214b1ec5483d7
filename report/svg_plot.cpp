#include "report/svg_plot.hpp"

#include <fmt/format.h>

#include <cmath>

#include "report/markup.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::report {
namespace {

constexpr double kWidth = 900, kHeight = 480, kLeft = 70, kRight = 20, kTop = 40, kBottom = 55;

}  // namespace

SvgPlot::SvgPlot(std::string title, std::string x_label, std::string y_label)
    : title_(std::move(title)), x_label_(std::move(x_label)), y_label_(std::move(y_label)) {}

std::pair<double, double> SvgPlot::pixel(double x, double y) const {
  return {kLeft + (x - x_.first) / (x_.second - x_.first) * (kWidth - kLeft - kRight),
          kHeight - kBottom - (y - y_.first) / (y_.second - y_.first) * (kHeight - kTop - kBottom)};
}

void SvgPlot::dots(const Points& points, const std::string& colour, double diameter_px) {
  body_ += fmt::format("<path stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" d=\"",
                       colour, diameter_px);
  for (const auto& [x, y] : points) {
    const auto [px, py] = pixel(x, y);
    body_ += fmt::format("M{:.1f} {:.1f}h0", px, py);
  }
  body_ += "\"/>\n";
}

void SvgPlot::line(const Points& points, const std::string& colour, bool dashed) {
  body_ += fmt::format("<path fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{} d=\"", colour,
                       dashed ? " stroke-dasharray=\"6 4\"" : "");
  bool broken = true;
  for (const auto& [x, y] : points) {
    if (!std::isfinite(x) || !std::isfinite(y)) {
      broken = true;
      continue;
    }
    const auto [px, py] = pixel(x, y);
    body_ += fmt::format("{}{:.1f} {:.1f}", broken ? 'M' : 'L', px, py);
    broken = false;
  }
  body_ += "\"/>\n";
}

void SvgPlot::text(double x, double y, const std::string& words) {
  const auto [px, py] = pixel(x, y);
  body_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", px, py, escaped(words));
}

std::string SvgPlot::axes() const {
  std::string out = fmt::format(
      "<text x=\"{}\" y=\"22\" font-size=\"15\" text-anchor=\"middle\">{}</text>\n"
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n"
      "<text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
      kWidth / 2, escaped(title_), kWidth / 2, kHeight - 12, escaped(x_label_), kHeight / 2,
      escaped(y_label_));
  for (const bool horizontal : {true, false}) {
    const auto [from, to] = horizontal ? x_ : y_;
    const double step = round_step_above(std::abs(to - from) / 8), low = std::min(from, to);
    for (double k = std::ceil(low / step - 1e-9); k * step <= std::max(from, to) + 1e-9 * step;
         ++k) {
      const auto [px, py] = horizontal ? pixel(k * step, y_.first) : pixel(x_.first, k * step);
      const double to_x = horizontal ? px : kWidth - kRight, to_y = horizontal ? kTop : py;
      out += fmt::format(
          "<path stroke=\"#ddd\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>"
          "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{:g}</text>\n",
          px, py, to_x, to_y, horizontal ? px : px - 6, horizontal ? py + 16 : py + 4,
          horizontal ? "middle" : "end", k == 0 ? 0.0 : k * step);
    }
  }
  return out;
}

std::string SvgPlot::svg() const {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
             "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n"
             "<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
             kWidth, kHeight) +
         axes() + body_ + "</svg>\n";
}

void SvgPlot::write(const std::filesystem::path& path) const {
  io::write_atomically(path, svg() + "<!-- Underbrush -->\n");
}

}  // namespace underbrush::report
