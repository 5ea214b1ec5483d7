/// Plots of points and lines over two axes, as SVG files.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace underbrush::report {

/// A plot. An axis may run from a larger to a smaller value.
class SvgPlot {
 public:
  using Points = std::vector<std::pair<double, double>>;

  SvgPlot(std::string title, std::string x_label, std::string y_label);
  void x_axis(double left, double right) { x_ = {left, right}; }
  void y_axis(double bottom, double top) { y_ = {bottom, top}; }

  /// Adds dots of one colour.
  void dots(const Points& points, const std::string& colour, double diameter_px);
  /// Adds a line, which is interrupted where a value is not finite.
  void line(const Points& points, const std::string& colour, bool dashed = false);
  /// Adds words at a place on the plot.
  void text(double x, double y, const std::string& words);

  /// Returns the plot as one `<svg>` element.
  std::string svg() const;
  /// Writes the plot to a file, atomically.
  void write(const std::filesystem::path& path) const;

 private:
  std::pair<double, double> pixel(double x, double y) const;
  std::string axes() const;

  std::string title_, x_label_, y_label_;
  std::pair<double, double> x_{0, 1}, y_{0, 1};
  std::string body_;
};

}  // namespace underbrush::report
