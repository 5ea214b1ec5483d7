#include "underbrush/io/poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/log_layout.hpp"
#include "underbrush/io/pose_columns.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

constexpr double kRotationError = 5e-3;  // Files print as few as three decimals.

/// Refuses times that are all the same, as the zeros of a recorder that had none.
void check_changing(const fs::path& path, const std::vector<double>& times) {
  const bool same = std::ranges::adjacent_find(times, std::not_equal_to<>()) == times.end();
  if (times.size() < 2 || !same) return;
  char text[60];
  std::snprintf(text, sizeof text, "all %zu times are %.10g", times.size(), times[0]);
  throw FormatError(path.string(), "", text);
}

void check_rising(const fs::path& path, const std::vector<double>& times) {
  check_changing(path, times);
  for (size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    throw FormatError(path.string(), "row " + std::to_string(i + 1),
                      times[i] == times[i - 1] ? "the same time twice" : "times not in order");
  }
}

void check_unique(const fs::path& path, std::vector<double> times) {
  check_changing(path, times);
  std::sort(times.begin(), times.end());
  const auto twice = std::adjacent_find(times.begin(), times.end());
  if (twice == times.end()) return;
  throw FormatError(path.string(), "time " + std::to_string(*twice), "more than one pose");
}

constexpr const char* kTooFar = "a position beyond 67 108 km";

// A log cannot hold positions beyond this.
bool is_near_enough(const Vec3& position) { return is_within(position, kMaxCoordinate); }

/// The pose of a row; its columns are those of time, position x y z and quaternion x y z w.
std::optional<Pose> pose_from_tum(const std::vector<double>& v, const PoseColumns& at) {
  Pose pose{{v[at[7]], v[at[4]], v[at[5]], v[at[6]]}, {v[at[1]], v[at[2]], v[at[3]]}};
  if (!(std::abs(pose.rotation.norm() - 1) < kRotationError)) return std::nullopt;
  if (!is_near_enough(pose.translation)) return std::nullopt;
  pose.rotation.normalize();
  return pose;
}

/// Reads the rows of a file of poses with quaternions.
PoseList quaternion_poses(const fs::path& path, const NumberRows& numbers,
                          const PoseColumns& columns) {
  PoseList out;
  for (size_t i = 0; i < numbers.rows.size(); ++i) {
    const auto& row = numbers.rows[i];
    const auto fail = [&](const std::string& reason) {
      throw FormatError(path.string(), "line " + std::to_string(numbers.line[i]), reason);
    };
    if (row.size() != numbers.rows[0].size()) fail("the number of columns changes");
    const std::optional<Pose> pose = pose_from_tum(row, columns);
    if (!is_near_enough({row[columns[1]], row[columns[2]], row[columns[3]]})) fail(kTooFar);
    if (!pose) fail("the quaternion's length is not 1");
    out.pose.push_back(*pose);
    out.time_s.push_back(row[columns[0]]);
  }
  return out;
}

/// Reads the rows of a file of poses with matrices, which may have a time before them.
PoseList matrix_poses(const fs::path& path, const NumberRows& numbers, const std::string& unknown) {
  PoseList out;
  out.numbered = numbers.rows[0].size() == 13;
  for (size_t i = 0; i < numbers.rows.size(); ++i) {
    const auto& row = numbers.rows[i];
    const auto fail = [&](const std::string& reason) {
      throw FormatError(path.string(), "line " + std::to_string(numbers.line[i]), reason);
    };
    if (row.size() != numbers.rows[0].size()) fail("the number of columns changes");
    std::array<double, 12> rows{};
    std::copy_n(row.end() - 12, 12, rows.begin());
    const std::optional<Pose> pose = pose_from_rows(rows);
    if (!pose) fail("not a rotation, or a position beyond 67 108 km" + unknown);
    out.pose.push_back(*pose);
    if (row.size() == 13) out.time_s.push_back(row[0]);
    out.numbered = out.numbered && row[0] >= 0 && row[0] < 1e7 && row[0] == std::floor(row[0]);
  }
  return out;
}

/// The line above the rows that names their columns, each of which has a place in a row; "" if
/// there is none.
std::string_view line_of_names(const NumberRows& numbers) {
  for (const std::string& head : numbers.heads) {
    const std::optional<PoseColumns> columns = pose_columns_of(head);
    if (!columns) continue;
    const size_t last = *std::max_element(columns->begin(), columns->end());
    if (last < numbers.rows[0].size()) return head;
  }
  return "";
}

/// What the names of the columns add to an error, where they are not understood.
std::string unknown_names(const NumberRows& numbers) {
  const size_t n = numbers.rows[0].size();
  for (const std::string& head : numbers.heads) {
    const bool as_many = n != 8 && words_of(head).size() == n;
    if (!as_many && !names_positions(head, n)) continue;
    return ": its header '" + printable(head, 60) +
           "' does not name t x y z qx qy qz qw, which are the columns of poses without a matrix";
  }
  return "";
}

}  // namespace

std::optional<Pose> pose_from_rows(const std::array<double, 12>& rows) {
  Mat3 r;
  Vec3 t;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = rows[4 * size_t(i) + size_t(j)];
    t[i] = rows[4 * size_t(i) + 3];
  }
  const double error = (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!is_near_enough(t) || !(error < 2 * kRotationError) || r.determinant() < 0)
    return std::nullopt;
  return Pose{Eigen::Quaterniond(r).normalized(), t};
}

namespace {

/// Leaves out the last rows, 0 0 0 1, of matrices of 4x4.
void drop_last_rows(NumberRows& numbers) {
  const auto is_square = [](const std::vector<double>& row) {
    const size_t n = row.size();
    return (n == 16 || n == 17) && row[n - 1] == 1 && row[n - 2] == 0 && row[n - 3] == 0 &&
           row[n - 4] == 0;
  };
  if (!std::ranges::all_of(numbers.rows, is_square)) return;
  for (std::vector<double>& row : numbers.rows) row.resize(row.size() - 4);
}

}  // namespace

PoseList read_poses(const fs::path& path) {
  constexpr PoseColumns kTum{0, 1, 2, 3, 4, 5, 6, 7};
  NumberRows numbers = read_numbers(path);
  drop_last_rows(numbers);
  const std::string angles = use_angles(path.string(), numbers);
  const std::string_view names = line_of_names(numbers);
  const std::optional<PoseColumns> named = pose_columns_of(names);
  const size_t n = numbers.rows[0].size();
  const std::string unknown = named ? "" : unknown_names(numbers);
  if (!named && ((n != 8 && n != 12 && n != 13) || (n == 8 && !unknown.empty()))) {
    throw FormatError(path.string(), "line " + std::to_string(numbers.line[0]),
                      n == 8 ? "which number of the quaternions is w is not known" + unknown
                             : "expected 8 (TUM), 12 (KITTI), 13, 16 or 17 numbers, found " +
                                   std::to_string(n) + unknown);
  }
  const bool quaternions = named || n == 8;
  PoseList out = quaternions ? quaternion_poses(path, numbers, named.value_or(kTum))
                             : matrix_poses(path, numbers, unknown);
  if (const auto part = seconds_part_of(names)) {
    for (size_t i = 0; i < out.time_s.size(); ++i) {
      out.time_s[i] += part->second * numbers.rows[i][part->first];
    }
  }
  if (named && *named != kTum) {
    const bool first = (*named)[7] < (*named)[4];
    out.notes.push_back(first ? "the poses' quaternions are qw qx qy qz, as in their header"
                              : "the poses' columns are in the order of their header");
  }
  if (!angles.empty()) out.notes.push_back(angles);
  if (const std::string unit = use_dates(out.time_s); !unit.empty()) {
    out.notes.push_back("the times of the poses are taken to be " + unit);
  }
  check_unique(path, out.time_s);
  return out;
}

namespace {

Trajectory path_of_log(const fs::path& path) {
  const LogReader log(path);
  std::vector<StampedPose> poses;
  for (const ScanInfo& scan : log.info().scans)
    poses.push_back({scan.time_s, scan.world_from_sensor});
  if (poses.empty()) throw FormatError(path.string(), "", "a log without the poses of its scans");
  try {
    return Trajectory(std::move(poses));
  } catch (const std::invalid_argument& e) {
    throw FormatError(path.string(), "its scans", e.what());
  }
}

}  // namespace

Trajectory read_trajectory(const fs::path& path) {
  if (is_log_name(path)) return path_of_log(path);
  const PoseList list = read_poses(path);
  if (list.pose.empty()) throw FormatError(path.string(), "", "no poses");
  if (list.time_s.empty()) {
    throw FormatError(path.string(), "",
                      "its poses have no times; give TUM rows (t tx ty tz qx qy qz qw)");
  }
  std::vector<StampedPose> poses(list.pose.size());
  for (size_t i = 0; i < poses.size(); ++i) poses[i] = {list.time_s[i], list.pose[i]};
  return Trajectory(std::move(poses));
}

std::string use_dates(std::vector<double>& times) {
  if (times.empty()) return "";
  const auto [low, high] = std::minmax_element(times.begin(), times.end());
  for (const auto& [name, unit] : {std::pair("ms", 1e-3), {"µs", 1e-6}, {"ns", 1e-9}}) {
    if (!(*low * unit > 1e9 && *high * unit < 4.2e9)) continue;
    for (double& t : times) t *= unit;
    return std::string(name) + " since 1970";
  }
  return "";
}

std::vector<double> read_times(const fs::path& path) {
  const NumberRows numbers = read_numbers(path);
  std::vector<double> times;
  for (size_t i = 0; i < numbers.rows.size(); ++i) {
    if (numbers.rows[i].size() != 1) {
      throw FormatError(path.string(), "line " + std::to_string(numbers.line[i]),
                        "expected one number");
    }
    times.push_back(numbers.rows[i][0]);
  }
  check_rising(path, times);
  return times;
}

std::vector<double> read_dates(const fs::path& path) {
  const std::string text = read_text(path, uint64_t(1) << 30);
  std::vector<double> times;
  size_t blank = 0;  // lines since the last date
  for_each_line(text, [&](size_t, std::string_view line) {
    if (words_of(line).empty()) {
      ++blank;
      return;
    }
    const auto time = time_of_date(line);
    if (!time || (times.empty() && blank > 0)) {
      throw FormatError(path.string(), "row " + std::to_string(times.size() + 1),
                        "expected YYYY-MM-DD hh:mm:ss.nnnnnnnnn");
    }
    const double step = blank > 0 ? (*time - times.back()) / double(blank + 1) : 0;
    for (; blank > 0; --blank) times.push_back(*time - double(blank) * step);
    times.push_back(*time);
  });
  check_rising(path, times);
  return times;
}

std::optional<std::vector<double>> read_calibration(const fs::path& path, const std::string& key) {
  if (!fs::exists(path)) return std::nullopt;
  const std::string text = read_text(path, 1 << 20);
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const auto words = words_of(std::string_view(text).substr(at, end - at));
    at = end + 1;
    if (words.empty() || words[0] != key + ":") continue;
    std::vector<double> values;
    for (size_t i = 1; i < words.size(); ++i) {
      const auto value = number_of(words[i]);
      if (!value || !std::isfinite(*value)) {
        throw FormatError(path.string(), key, "expected finite numbers");
      }
      values.push_back(*value);
    }
    return values;
  }
  return std::nullopt;
}

std::string times_of_poses(double time_s, double first_s, double last_s) {
  constexpr double kDates = 978307200, kWeek = 604800;  // s; from 2001 on
  constexpr double kFirstWeek = 315964800, kLeap = 18;  // s; of GPS, ahead of UTC since 2017
  const double week_s = std::fmod(time_s - kFirstWeek + kLeap, kWeek);
  const char* clock = "";
  if (time_s >= kDates && last_s < kDates) {
    const bool of_week = week_s > first_s - kLeap && week_s < last_s + kLeap;
    clock = of_week           ? "; they are seconds of the GPS week, the scans' are dates"
            : last_s <= kWeek ? "; they may be seconds of the GPS week or of a clock that starts "
                                "at zero, the scans' are dates"
                              : "; the scans' are dates";
  } else if (time_s < kDates && first_s >= kDates) {
    clock =
        "; they are dates, the scans' may be seconds of the GPS week or of a clock that starts "
        "at zero";
  }
  char text[240];
  std::snprintf(text, sizeof text, ": the times of the poses go from %.3f to %.3f s%s", first_s,
                last_s, clock);
  return text;
}

}  // namespace underbrush::io
