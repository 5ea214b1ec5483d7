/// \file
/// Progress on standard error, and numbers in a readable form.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace underbrush::app {

/// A line of progress on standard error; nothing is printed unless that is a terminal.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  /// Shows that `done` of `total` is done; draws at most ten times a second.
  void operator()(size_t done, size_t total);

 private:
  std::string what_;
  bool shown_ = false, terminal_;
  double last_s_ = 0, start_s_;
};

/// Progress of work in stages, with a line for each stage.
class StageProgress {
 public:
  void operator()(std::string_view stage, size_t done, size_t total);

 private:
  std::string stage_;
  std::unique_ptr<Progress> line_;
};

/// Returns a function that shows the progress of one call, to which it is passed as a temporary;
/// with the call the line ends. `what` is the beginning of the line.
template <class Line, class... What>
auto shown(What... what) {
  return [line = std::make_shared<Line>(what...)](auto... done) { (*line)(done...); };
}

/// Writes a number with a prefix: 12 345 678 becomes "12.3 M".
std::string si(double value);

}  // namespace underbrush::app
