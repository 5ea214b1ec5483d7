#include "underbrush/pipeline/pose_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/pipeline/check_values.hpp"
#include "underbrush/pipeline/scan_overlap.hpp"

namespace underbrush::pipeline {
namespace {

/// Points of a scan whose overlap with another one tells something.
constexpr size_t kFewestPoints = 250;

std::string warning_of_speed(const std::vector<ScanInfo>& scans) {
  constexpr double kFast = 100;  // m/s
  std::vector<double> speed;
  for (size_t i = 1; i < scans.size(); ++i) {
    const double time = scans[i].time_s - scans[i - 1].time_s;
    if (!(time > 0)) continue;
    speed.push_back(
        (scans[i].world_from_sensor.translation - scans[i - 1].world_from_sensor.translation)
            .norm() /
        time);
  }
  const double usual = median(speed);
  if (usual < kFast) return "";
  return "by the poses the sensor moves at " + text_of("%.0f", usual) +
         " m/s: are their positions in mm, or their times not in s?";
}

std::string warning_of_climb(const std::vector<ScanInfo>& scans) {
  constexpr double kFewest = 5, kMostly = 0.7;  // m; of the way
  double way = 0, up = 0;
  for (size_t i = 1; i < scans.size(); ++i) {
    const Vec3 step =
        scans[i].world_from_sensor.translation - scans[i - 1].world_from_sensor.translation;
    way += step.norm();
    up += step.z();
  }
  if (way < kFewest || std::abs(up) < kMostly * way) return "";
  return "by the poses the sensor moves " + text_of("%.0f", std::abs(up)) +
         (up > 0 ? " m up" : " m down") + " on a way of " + text_of("%.0f", way) +
         " m: are they poses of a camera, whose z points ahead?";
}

/// A way to read poses, the first as they are.
struct Reading {
  const char* what;
  Pose (*pose)(const Pose&);
};
constexpr std::array<Reading, 4> kReadings{{
    {"", [](const Pose& p) { return p; }},
    {"if they are inverted: are they sensor from world?",
     [](const Pose& p) { return p.inverse(); }},
    {"with w as the first number of the quaternions: are they qw qx qy qz?",
     [](const Pose& p) {
       const Eigen::Quaterniond& q = p.rotation;
       return Pose{Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), p.translation};
     }},
    {"with positions a thousandth as far: are they in mm?",
     [](const Pose& p) {
       return Pose{p.rotation, p.translation / 1e3};
     }},
}};

/// Pairs of scans with some motion between them.
std::vector<std::pair<size_t, size_t>> pairs_of(const std::vector<ScanInfo>& infos) {
  constexpr size_t kPairs = 4, kAhead = 30;
  constexpr double kFar = 1, kTurned = 0.17;  // m, rad
  std::vector<std::pair<size_t, size_t>> out;
  for (size_t k = 0; k < kPairs; ++k) {
    const size_t a = k * infos.size() / kPairs;
    for (size_t b = a + 1; b < std::min(infos.size(), a + kAhead); ++b) {
      const Pose &from = infos[a].world_from_sensor, &to = infos[b].world_from_sensor;
      if ((from.translation - to.translation).norm() < kFar &&
          from.rotation.angularDistance(to.rotation) < kTurned) {
        continue;
      }
      out.emplace_back(a, b);
      break;
    }
  }
  return out;
}

/// How well the motion by the poses fits some scans, and the motions that fit them best.
struct MotionFit {
  double given = 0, best = 0;  ///< Mean shares of a scan's points where an earlier one has some.
  double given_m = 0, best_m = 0, given_rad = 0, best_rad = 0;  ///< Mean motion.
};

/// The turn from the sensor's frame to one whose z axis is that of the world.
Eigen::Quaterniond upright_of(const ScanInfo& scan) {
  return turn_between(scan.world_from_sensor.rotation.inverse() * Vec3::UnitZ(), Vec3::UnitZ());
}

/// Nothing where a scan is too sparse to tell.
std::optional<MotionFit> motion_fit(ScanSource& scans, const std::vector<ScanInfo>& infos,
                                    size_t ahead) {
  constexpr size_t kPairs = 4, kPoints = 800;
  MotionFit fit;
  for (size_t k = 0; k < kPairs; ++k) {
    const size_t a = k * (infos.size() - ahead) / kPairs;
    const Eigen::Quaterniond upright = upright_of(infos[a]);
    const std::vector<Vec3> earlier = upper_points(scans.read(a), upright, SIZE_MAX);
    const ScanCells cells(earlier);
    if (earlier.size() < kFewestPoints) return std::nullopt;
    const std::vector<Vec3> later = upper_points(scans.read(a + ahead), upright, kPoints);
    const Pose turn{upright, Vec3::Zero()};
    const Pose given = turn * infos[a].world_from_sensor.inverse() *
                       infos[a + ahead].world_from_sensor * turn.inverse();
    const ScanMotion best = best_motion(cells, later);
    fit.given += cells.share_of(later, given) / kPairs;
    fit.best += best.share / kPairs;
    fit.given_m += given.translation.norm() / kPairs;
    fit.best_m += best.pose.translation.norm() / kPairs;
    fit.given_rad += given.rotation.angularDistance(Eigen::Quaterniond::Identity()) / kPairs;
    fit.best_rad += best.pose.rotation.angularDistance(Eigen::Quaterniond::Identity()) / kPairs;
  }
  return fit;
}

/// "the next one", or which scan after a scan is meant.
std::string scan_ahead(size_t ahead) {
  return ahead == 1 ? "the next one" : "the one " + std::to_string(ahead) + " scans later";
}

/// Warns where scans fit each other clearly better with other motions than by the poses. A sensor
/// that stands by the poses may in truth move slowly, which shows after many scans only.
std::string warning_of_motion(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr double kBetter = 0.2, kStands = 0.1;  // kStands: m
  bool stood = true;
  for (const size_t ahead : {1, 3, 10, 30, 100}) {
    if (infos.size() <= ahead || (ahead > 3 && !stood)) break;
    const std::optional<MotionFit> found = motion_fit(scans, infos, ahead);
    if (!found) return "";
    const MotionFit& fit = *found;
    stood = fit.given_m < kStands;
    if (fit.best < fit.given + kBetter) continue;
    const auto motion = [](double way_m, double turn_rad) {
      return text_of("%.1f", way_m) + " m and turns by " + text_of("%.0f", turn_rad * 180 / M_PI) +
             "°";
    };
    const bool stands = fit.given_m < kStands && fit.best_m > kStands;
    return "by the poses the sensor " +
           (stands ? "stands still" : "moves by " + motion(fit.given_m, fit.given_rad)) + ", and " +
           text_of("%.0f", 100 * fit.given) + " % of a scan's points lie where " +
           scan_ahead(ahead) + " has some, but " + text_of("%.0f", 100 * fit.best) +
           " % if it moves by " + motion(fit.best_m, fit.best_rad) +
           (stands ? ": are all poses the same, or in km?"
                   : ": are their rotations and axes those of the sensor, and their times those of "
                     "the scans?");
  }
  return "";
}

std::string warning_of_overlap(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr double kPoor = 0.4, kGood = 0.6, kBetter = 0.2;
  constexpr double kFast = 5;  // m from scan to scan
  const std::vector<std::pair<size_t, size_t>> pairs = pairs_of(infos);
  if (pairs.empty()) return warning_of_motion(scans, infos);
  std::array<double, kReadings.size()> fit{};
  bool fast = true;
  for (const auto& [a, b] : pairs) {
    const Vec3 way =
        infos[b].world_from_sensor.translation - infos[a].world_from_sensor.translation;
    fast = fast && way.norm() > kFast * double(b - a);
    const Eigen::Quaterniond none = Eigen::Quaterniond::Identity();
    const std::vector<Vec3> from = upper_points(scans.read(a), none, SIZE_MAX);
    const ScanCells cells(from);
    if (from.size() < kFewestPoints) return "";
    const std::vector<Vec3> to = upper_points(scans.read(b), none, 4000);
    for (size_t k = 0; k < kReadings.size(); ++k) {
      const auto& pose_of = kReadings[k].pose;
      const Pose between =
          pose_of(infos[a].world_from_sensor).inverse() * pose_of(infos[b].world_from_sensor);
      fit[k] += cells.share_of(to, between) / double(pairs.size());
    }
  }
  // Circles on flat ground fit each other best without any motion, so it alone shows no mm.
  if (!fast) fit.back() = 0;
  const size_t best = size_t(std::max_element(fit.begin(), fit.end()) - fit.begin());
  if (fit[0] > kGood) return "";
  if (fit[0] > kPoor || fit[best] < fit[0] + kBetter) return warning_of_motion(scans, infos);
  return "by the poses only " + text_of("%.0f", 100 * fit[0]) +
         " % of a scan's points lie where the next one has some, and " +
         text_of("%.0f", 100 * fit[best]) + " % " + kReadings[best].what;
}

/// The number of neighbouring cells (1 m) about a sensor whose lowest points lie below it, in a
/// frame turned from its own, and at about the same height, and that of all.
std::pair<double, double> level_pairs(const PointScan& scan, const Eigen::Quaterniond& turn) {
  constexpr double kNear = 2, kFar = 20, kStep = 0.3;  // m
  std::map<std::pair<int, int>, double> lowest;
  for (const Vec3f& point : scan.point) {
    if (!is_return(point) || point.norm() < kNear || point.norm() > kFar) continue;
    const Vec3 p = turn * point.cast<double>();
    double& z =
        lowest.try_emplace({int(std::floor(p.x())), int(std::floor(p.y()))}, p.z()).first->second;
    z = std::min(z, p.z());
  }
  size_t pairs = 0, level = 0;
  for (const auto& [cell, z] : lowest) {
    for (const auto& next :
         {std::pair(cell.first + 1, cell.second), std::pair(cell.first, cell.second + 1)}) {
      const auto other = lowest.find(next);
      if (other == lowest.end()) continue;
      ++pairs;
      level += z < 0 && other->second < 0 && std::abs(z - other->second) < kStep;
    }
  }
  return {double(level), double(pairs)};
}

/// Warns where the ground of up to four scans is not level below the sensor by the poses, but would
/// be so without their rotations or if the sensor hung upside down.
std::string warning_of_ground(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr size_t kTried = 4;
  constexpr double kPoor = 0.5, kLevel = 0.4;  // of the level cells as they would be; of all
  const Eigen::Quaterniond over(Eigen::AngleAxisd(M_PI, Vec3::UnitX()));
  double given = 0, unturned = 0, hanging = 0, all = 0;
  for (size_t k = 0; k < kTried; ++k) {
    const size_t i = k * infos.size() / kTried;
    const PointScan scan = scans.read(i);
    const Eigen::Quaterniond& turn = infos[i].world_from_sensor.rotation;
    given += level_pairs(scan, turn).first;
    hanging += level_pairs(scan, turn * over).first;
    const auto [level, pairs] = level_pairs(scan, Eigen::Quaterniond::Identity());
    unturned += level;
    all += pairs;
  }
  const auto is_better = [&](double other) {
    return all > 0 && other >= kLevel * all && given <= kPoor * other;
  };
  const bool tilted = are_tilted(infos);
  const bool level = all > 0 && given >= kLevel * all;
  std::string w_first = tilted && !level ? warning_of_tilt(infos) : "";
  if (!w_first.empty()) return w_first;
  if (tilted && is_better(unturned)) {
    return "by the poses the ground is steep or above the sensor, and it is level without their "
           "rotations: are they poses of a camera or of another frame, or quaternions with w as "
           "the first number?";
  }
  if (is_better(hanging)) {
    return "by the poses the ground is above the sensor: does the sensor hang upside down? Then "
           "the poses must turn from its own frame";
  }
  return "";
}

}  // namespace

std::string warning_of_tilt(const std::vector<ScanInfo>& scans) {
  constexpr double kUpright = 0.94, kTilted = 0.7, kMost = 0.8;  // cosines; of the poses
  size_t tilted = 0, upright = 0;
  for (const ScanInfo& scan : scans) {
    const Eigen::Quaterniond& q = scan.world_from_sensor.rotation;
    // The four numbers in their order, with w taken as the first.
    const Eigen::Quaterniond w_first(q.x(), q.y(), q.z(), q.w());
    tilted += (q * Vec3::UnitZ()).z() < kTilted;
    upright += (w_first.normalized() * Vec3::UnitZ()).z() > kUpright;
  }
  const double most = kMost * double(scans.size());
  if (double(tilted) < most || double(upright) < most) return "";
  return "by the poses the sensor lies on its side or its head, and is upright with w first: are "
         "their quaternions qw qx qy qz? Then say so in a line above them: # t x y z qw qx qy qz";
}

bool are_tilted(const std::vector<ScanInfo>& scans) {
  constexpr double kTilted = 0.8, kMost = 0.8;  // cosine; of the poses
  const auto tilted = std::ranges::count_if(scans, [](const ScanInfo& scan) {
    return (scan.world_from_sensor.rotation * Vec3::UnitZ()).z() < kTilted;
  });
  return tilted > 0 && double(tilted) >= kMost * double(scans.size());
}

std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans) {
  std::vector<std::string> out;
  for (std::string w : {warning_of_speed(scans), warning_of_climb(scans)}) {
    if (!w.empty()) out.push_back(std::move(w));
  }
  return out;
}

std::string warning_of_scans(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  const std::string ground = warning_of_ground(scans, infos);
  return ground.empty() ? warning_of_overlap(scans, infos) : ground;
}

}  // namespace underbrush::pipeline
