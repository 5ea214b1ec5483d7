#include "underbrush/io/scan_clock.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace {

constexpr size_t kFewest = 8;  // scans to which a clock is fitted
constexpr double kStepsS[] = {0.05, 0.025, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005};
constexpr double kNear = 0.75;  // steps; a time that lies farther off is no rounded one

/// A revolution's number and its time after the first scan, s.
struct Tick {
  double turn, time_s;
};
using Ticks = std::vector<Tick>;

// The mean of the spacings that are near the median: whole periods without gaps.
double mean_spacing(const std::vector<double>& times) {
  std::vector<double> spacing;
  for (size_t i = 1; i < times.size(); ++i) spacing.push_back(times[i] - times[i - 1]);
  std::vector<double> sorted = spacing;
  std::nth_element(sorted.begin(), sorted.begin() + long(sorted.size() / 2), sorted.end());
  const double middle = sorted[sorted.size() / 2];
  double sum = 0;
  size_t n = 0;
  for (const double s : spacing) {
    if (std::abs(s - middle) > 0.4 * middle) continue;
    sum += s;
    ++n;
  }
  return sum / double(n);
}

// The step to which the times were rounded.
std::optional<double> rounding_step(const std::vector<double>& times, double period) {
  for (const double step : kStepsS) {
    if (step > period / 4) continue;
    std::complex<double> sum = 0;
    for (const double t : times) sum += std::polar(1.0, 2 * M_PI * (t - times[0]) / step);
    const double phase = std::arg(sum) / (2 * M_PI) * step;
    const auto on_it = std::count_if(times.begin(), times.end(), [&](double t) {
      return std::abs(std::remainder(t - times[0] - phase, step)) <= step / 8;
    });
    if (double(on_it) >= 0.8 * double(times.size())) return step;
  }
  return std::nullopt;
}

// The ticks of each part of the recording that has no pause in it.
std::vector<Ticks> parts_of(const std::vector<double>& times, double period, double step) {
  std::vector<Ticks> parts{{{0, 0}}};
  for (size_t i = 1; i < times.size(); ++i) {
    const double spacing = times[i] - times[i - 1];
    const double turns = std::max(1.0, std::round(spacing / period));
    const bool pause = turns > 10 || std::abs(spacing - turns * period) > 2 * step;
    const double turn = pause ? 0 : parts.back().back().turn + turns;
    if (pause) parts.emplace_back();
    parts.back().push_back({turn, times[i] - times[0]});
  }
  return parts;
}

/// The line time = start + period · (turn − about).
struct Line {
  double about, start_s, period_s;
  double at(double turn) const { return start_s + period_s * (turn - about); }
};

// Fits a line to the ticks [begin, end) by least squares. Times that lie off the line of the round
// before by more than three quarters of a step are left out; the first round takes all.
Line line_through(const Ticks& ticks, size_t begin, size_t end, double step) {
  Line line{};
  for (int round = 0; round < 5; ++round) {
    double n = 0, turn = 0, time = 0, square = 0, product = 0;
    const auto each_used = [&](auto&& use) {
      for (size_t i = begin; i < end; ++i) {
        const Tick& t = ticks[i];
        if (round == 0 || std::abs(t.time_s - line.at(t.turn)) <= kNear * step) use(t);
      }
    };
    each_used([&](const Tick& t) { n += 1, turn += t.turn, time += t.time_s; });
    if (n < 3) break;
    turn /= n, time /= n;
    each_used([&](const Tick& t) {
      square += (t.turn - turn) * (t.turn - turn);
      product += (t.turn - turn) * (t.time_s - time);
    });
    line = {turn, time, product / square};
  }
  return line;
}

// The fitted times of all ticks. A window of as many scans as there are is one line for all.
std::vector<double> smoothed(const Ticks& ticks, size_t window, double step) {
  std::vector<double> out;
  const size_t n = ticks.size();
  Line line = line_through(ticks, 0, std::min(window, n), step);
  for (size_t i = 0; i < n; ++i) {
    const size_t begin = std::min(i - std::min(i, window / 2), n - std::min(n, window));
    if (begin > 0) line = line_through(ticks, begin, std::min(n, begin + window), step);
    out.push_back(line.at(ticks[i].turn));
  }
  return out;
}

double square_mean(const Ticks& ticks, const std::vector<double>& fitted, double limit,
                   size_t& within) {
  double sum = 0;
  within = 0;
  for (size_t i = 0; i < ticks.size(); ++i) {
    const double off = ticks[i].time_s - fitted[i];
    if (std::abs(off) > limit) continue;
    sum += off * off;
    ++within;
  }
  return within > 0 ? sum / double(within) : 0;
}

// The times of a part by the straightest clock that explains them; nothing where none does.
std::optional<std::vector<double>> times_of_part(const Ticks& ticks, double step) {
  if (ticks.size() < kFewest) return std::nullopt;
  for (const size_t window : {ticks.size(), size_t(256), size_t(128), size_t(64), size_t(32)}) {
    if (window > ticks.size()) continue;
    std::vector<double> fitted = smoothed(ticks, window, step);
    size_t within = 0;
    const double rms = std::sqrt(square_mean(ticks, fitted, kNear * step, within));
    if (rms <= 0.36 * step && double(within) >= 0.95 * double(ticks.size())) return fitted;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ScanClock> fit_scan_clock(const std::vector<double>& times_s) {
  if (times_s.size() < kFewest) return std::nullopt;
  for (size_t i = 1; i < times_s.size(); ++i) {
    require(times_s[i - 1] < times_s[i], "fit_scan_clock: the times do not ascend");
  }
  const double spacing = mean_spacing(times_s);
  const std::optional<double> step = rounding_step(times_s, spacing);
  if (!step) return std::nullopt;
  ScanClock clock;
  clock.step_s = *step;
  double turns = 0, span = 0, squares = 0;
  for (const Ticks& part : parts_of(times_s, spacing, *step)) {
    const std::optional<std::vector<double>> fitted = times_of_part(part, *step);
    (fitted ? clock.fitted : clock.kept) += part.size();
    for (size_t i = 0; i < part.size(); ++i) {
      const double time = fitted ? (*fitted)[i] : part[i].time_s;
      clock.time_s.push_back(fitted ? times_s[0] + time : times_s[clock.time_s.size()]);
      squares += (part[i].time_s - time) * (part[i].time_s - time);
    }
    if (!fitted) continue;
    turns += part.back().turn;
    span += fitted->back() - fitted->front();
  }
  if (clock.fitted == 0) return std::nullopt;
  clock.period_s = span / turns;
  clock.residual_rms_s = std::sqrt(squares / double(clock.fitted));
  const bool ascend = std::adjacent_find(clock.time_s.begin(), clock.time_s.end(),
                                         std::greater_equal<>()) == clock.time_s.end();
  if (!ascend || clock.residual_rms_s < 0.05 * *step) return std::nullopt;
  return clock;
}

bool poses_follow_clock(const std::vector<StampedPose>& poses,
                        const std::vector<double>& fitted_s) {
  require(poses.size() == fitted_s.size(), "poses_follow_clock: not one time for each pose");
  const auto unsteadiness = [&](auto&& time) {
    double sum = 0;
    const auto velocity = [&](size_t i) -> Vec3 {
      return (poses[i + 1].world_from_sensor.translation - poses[i].world_from_sensor.translation) /
             (time(i + 1) - time(i));
    };
    for (size_t i = 2; i < poses.size(); ++i) sum += (velocity(i - 1) - velocity(i - 2)).norm();
    return sum;
  };
  return unsteadiness([&](size_t i) { return fitted_s[i]; }) <=
         unsteadiness([&](size_t i) { return poses[i].time_s; });
}

}  // namespace underbrush::io
