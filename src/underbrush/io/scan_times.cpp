#include "underbrush/io/scan_times.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "underbrush/io/pose_gaps.hpp"

namespace underbrush::io {
namespace {

/// The factor from the unit in which times of scans are written to seconds, and its name.
std::pair<double, const char*> unit_of(const std::vector<double>& times, const PoseList& poses,
                                       double period_s) {
  constexpr double kLongStep = 10, kShortest = 0.04, kLongest = 0.21;  // s
  constexpr std::array<std::pair<double, const char*>, 3> kTimeUnits{
      {{1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}}};
  const double usual = usual_step(times);
  if (!(usual > kLongStep)) return {1, "s"};
  if (!poses.time_s.empty() && !poses.numbered && &times != &poses.time_s) {
    const auto [low, high] = std::minmax_element(poses.time_s.begin(), poses.time_s.end());
    const auto within = [&, first = *low, last = *high](double unit) {
      return times.front() * unit >= first - 1 && times.back() * unit <= last + 1;
    };
    for (const auto& unit : kTimeUnits) {
      if (!within(1) && within(unit.first)) return unit;
    }
  }
  size_t even = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    const double steps = (times[i] - times[i - 1]) / usual;
    even += std::abs(steps - std::round(steps)) < 0.1;
  }
  if (double(even) < 0.8 * double(times.size() - 1)) return {1, "s"};
  for (const auto& unit : kTimeUnits) {
    const double step = usual * unit.first;
    const bool fits = period_s > 0 ? step > 0.7 * period_s && step < 10.3 * period_s
                                   : step > kShortest && step < kLongest;
    if (fits) return unit;
  }
  return {1, "s"};
}

}  // namespace

void use_seconds(ScanPlacing& placing, bool poses_have_the_scans_times,
                 std::vector<std::string>& notes) {
  PoseList& poses = placing.poses;
  const bool by_poses = placing.times.empty() && poses_have_the_scans_times;
  std::vector<double>& times = by_poses ? poses.time_s : placing.times;
  if (times.size() < 2) return;
  const auto [unit, name] = unit_of(times, poses, placing.period_s);
  if (unit == 1) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "the times of the scans are taken to be in %s: %.4g of them lie between scans",
                name, usual_step(times));
  notes.emplace_back(text);
  const bool same_unit = !by_poses && !poses.numbered && !poses.time_s.empty() &&
                         poses.time_s.back() >= times.front() && poses.time_s[0] <= times.back() &&
                         poses.time_s.back() > times.back() * unit + 1;
  for (double& t : times) t *= unit;
  if (!same_unit) return;
  for (double& t : poses.time_s) t *= unit;
}

void count_by_names(std::vector<ScanFile>& files, const ScanPlacing& placing,
                    std::vector<std::string>& notes) {
  const bool timed = !placing.poses.time_s.empty();
  const size_t rows = std::max(placing.times.size(), timed ? 0 : placing.poses.pose.size());
  const auto [low, high] = std::ranges::minmax(files, {}, &ScanFile::number);
  if (rows <= files.size() || !low.number || *high.number > rows) return;
  const uint32_t first = *high.number == rows ? 1 : 0;
  if (*low.number < first || files[0].frame == *files[0].number - first) return;
  for (ScanFile& file : files) file.frame = *file.number - first;
  notes.push_back(
      "the numbers in the scans' names are those of the poses and times, counted from " +
      std::to_string(first) + ": " + files[0].path.filename().string() + " has row " +
      std::to_string(files[0].frame + 1));
}

}  // namespace underbrush::io
