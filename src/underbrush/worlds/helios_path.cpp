#include "underbrush/worlds/helios_path.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::worlds {
namespace {

constexpr double kStepRad = M_PI / 12;  // between poses of a head that turns
constexpr double kMostPoses = 1e6;

Eigen::Quaterniond about(const Vec3& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

/// The pose of the scanner's head on a platform, after `turned_s` of turning.
StampedPose pose_of(double time_s, const Vec3& at, const Eigen::Quaterniond& attitude,
                    const ScannerMount& mount, const HeadTurn& head, double turned_s) {
  StampedPose p;
  p.time_s = time_s;
  p.world_from_sensor.translation = at + mount.position;
  const double angle = head.start_rad + head.speed_rad_per_s * (turned_s + 1 / head.pulse_hz);
  p.world_from_sensor.rotation =
      (attitude * mount.rotation * about(mount.head_axis, angle) * about(Vec3::UnitZ(), M_PI / 2))
          .normalized();
  return p;
}

size_t steps_of(const HeadTurn& head, double duration_s) {
  const double n = std::ceil(std::abs(head.speed_rad_per_s) * duration_s / kStepRad);
  require_data(n <= kMostPoses, "survey: the head turns too often");
  return size_t(std::max(1.0, n));
}

struct Row {
  double time_s;
  Vec3 at;
  Eigen::Quaterniond attitude;
};

/// Takes the columns from a line `#HEADER: "x", "y", …`, if it names all seven.
void use_header(std::string line, std::array<size_t, 7>& columns) {
  constexpr const char* kNames[] = {"t", "roll", "pitch", "yaw", "x", "y", "z"};
  std::replace(line.begin(), line.end(), '"', ' ');
  const auto words = io::words_of(std::string_view(line).substr(line.find(':') + 1));
  std::array<size_t, 7> found{};
  for (size_t c = 0; c < 7; ++c) {
    const auto at = std::find(words.begin(), words.end(), kNames[c]);
    if (at == words.end()) return;
    found[c] = size_t(at - words.begin());
  }
  columns = found;
}

/// Appends a row. One at the time of the row before it is a turn on the spot. Returns false where
/// times fall.
bool append(Row row, std::vector<Row>& rows) {
  constexpr double kTurnS = 1e-6;
  if (!rows.empty()) {
    const Row& last = rows.back();
    const double after = row.time_s - last.time_s;
    if (after < -2 * kTurnS) return false;
    if (after <= 0) {
      if (row.at == last.at && row.attitude.isApprox(last.attitude)) return true;
      row.time_s = last.time_s + kTurnS;
    }
  }
  rows.push_back(row);
  return true;
}

std::vector<Row> read_rows(const TrajectoryFile& file) {
  std::vector<Row> rows;
  std::string text = io::read_text(file.path, uint64_t(1) << 30);
  std::replace(text.begin(), text.end(), ',', ' ');
  const double unit = file.degrees ? M_PI / 180 : 1;
  std::array<size_t, 7> columns = file.columns;
  io::for_each_line(text, [&](size_t line, std::string_view content) {
    const auto words = io::words_of(content);
    if (words.empty()) return;
    if (words[0].starts_with('#')) {
      const bool named = !file.columns_given && words[0].starts_with("#HEADER");
      if (named) use_header(std::string(content), columns);
      return;
    }
    double v[7];
    for (size_t c = 0; c < 7; ++c) {
      const size_t at = columns[c];
      const auto number = at < words.size() ? io::number_of(words[at]) : std::nullopt;
      if (!number || !(std::abs(*number) <= 1e12)) {
        throw FormatError(file.path.string(), "line " + std::to_string(line),
                          "not the numbers t, roll, pitch, yaw, x, y, z");
      }
      v[c] = *number;
    }
    const double roll = v[1] * unit, pitch = v[2] * unit, yaw = v[3] * unit;
    const Eigen::Quaterniond attitude =
        file.canonical
            ? about(Vec3::UnitX(), roll) * about(Vec3::UnitY(), pitch) * about(Vec3::UnitZ(), yaw)
            : about(-Vec3::UnitZ(), yaw) * about(Vec3::UnitY(), roll) * about(Vec3::UnitX(), pitch);
    if (!append({v[0], {v[4], v[5], v[6]}, attitude}, rows)) {
      throw FormatError(file.path.string(), "line " + std::to_string(line), "times must rise");
    }
  });
  if (rows.size() < 2) throw FormatError(file.path.string(), "", "fewer than two poses");
  return rows;
}

}  // namespace

LegPath standing(const Vec3& at, const ScannerMount& mount, const HeadTurn& head, double start_s,
                 double longest_s) {
  LegPath path;
  double duration_s =
      head.speed_rad_per_s == 0 ? 0 : (head.stop_rad - head.start_rad) / head.speed_rad_per_s;
  if (longest_s > 0) duration_s = duration_s > 0 ? std::min(duration_s, longest_s) : longest_s;
  if (!(duration_s > 0)) return path;
  const size_t n = steps_of(head, duration_s);
  for (size_t k = 0; k <= n; ++k) {
    const double t = duration_s * double(k) / double(n);
    path.poses.push_back(pose_of(start_s + t, at, Eigen::Quaterniond::Identity(), mount, head, t));
  }
  return path;
}

LegPath flying(const Vec3& from, const Vec3& to, double speed_m_per_s, const ScannerMount& mount,
               const HeadTurn& head, double start_s, double longest_s) {
  LegPath path;
  Vec3 way = to - from;
  if (!(speed_m_per_s > 0) || !(way.norm() > 0)) return path;
  if (longest_s > 0) way *= std::min(1.0, longest_s * speed_m_per_s / way.norm());
  const double duration_s = way.norm() / speed_m_per_s;
  const double heading = way.head<2>().norm() > 0 ? std::atan2(-way.x(), way.y()) : 0;
  const Eigen::Quaterniond attitude = about(Vec3::UnitZ(), heading);
  const size_t n = steps_of(head, duration_s);
  for (size_t k = 0; k <= n; ++k) {
    const double share = double(k) / double(n);
    path.poses.push_back(pose_of(start_s + share * duration_s, from + share * way, attitude, mount,
                                 head, share * duration_s));
  }
  return path;
}

LegPath along_file(const TrajectoryFile& file, double from_s, double to_s, double longest_s,
                   const ScannerMount& mount, const HeadTurn& head) {
  LegPath path;
  for (const Row& row : read_rows(file)) {
    if (row.time_s < from_s || row.time_s > to_s) continue;
    const double first = path.poses.empty() ? row.time_s : path.poses.front().time_s;
    if (longest_s > 0 && row.time_s > first + longest_s) break;
    path.poses.push_back(
        pose_of(row.time_s, row.at, row.attitude, mount, head, row.time_s - first));
  }
  return path;
}

}  // namespace underbrush::worlds
