#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>

namespace underbrush::app {
namespace {

double now_s() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1), start_s_(now_s()) {}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::operator()(size_t done, size_t total) {
  if (!terminal_) return;
  const double t = now_s();
  if (t - last_s_ < 0.1) return;
  last_s_ = t;
  shown_ = true;
  const double share = total ? double(done) / double(total) : 0;
  const int filled = int(30 * share);
  std::string line =
      fmt::format("\r\x1b[K{} [{:-<30}] {:3.0f} %", what_, std::string(filled, '#'), 100 * share);
  if (share > 0.02) line += fmt::format("  {:.0f} s left", (t - start_s_) * (1 / share - 1));
  std::fputs(line.c_str(), stderr);
}

void StageProgress::operator()(std::string_view stage, size_t done, size_t total) {
  if (stage != stage_ || done == 0) {
    line_.reset();  // The old line clears itself before the next begins.
    stage_ = stage;
    line_ = std::make_unique<Progress>(stage_);
  }
  (*line_)(done, total);
}

std::string si(double value) {
  const char* units[] = {"", " k", " M", " G", " T"};
  int k = 0;
  while (std::abs(value) >= 1000 && k < 4) {
    value /= 1000;
    ++k;
  }
  return fmt::format("{:.3g}{}", value, units[k]);
}

}  // namespace underbrush::app
