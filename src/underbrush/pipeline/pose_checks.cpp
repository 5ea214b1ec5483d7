#include "underbrush/pipeline/pose_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "underbrush/core/cells.hpp"
#include "underbrush/pipeline/check_values.hpp"

namespace underbrush::pipeline {
namespace {

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

/// The upper half of a scan's points within 40 m, at most 4000: those on flat ground fit anyway.
std::vector<Vec3> upper_points(const PointScan& scan) {
  constexpr double kNear = 2, kFar = 40;  // m
  constexpr size_t kMost = 4000;
  std::vector<double> height;
  for (const Vec3f& p : scan.point) {
    if (is_return(p) && p.norm() > kNear && p.norm() < kFar) height.push_back(double(p.z()));
  }
  const double middle = median(height);
  const size_t step = std::max<size_t>(1, height.size() / kMost / 2);
  std::vector<Vec3> out;
  size_t n = 0;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p) || p.norm() < kNear || p.norm() > kFar || double(p.z()) < middle) continue;
    if (n++ % step == 0) out.push_back(p.cast<double>());
  }
  return out;
}

/// The share of the points `to` that lie in cells of the points `from`, each seen from its pose.
double overlap(const std::vector<Vec3>& from, const Pose& from_pose, const std::vector<Vec3>& to,
               const Pose& to_pose) {
  constexpr double kCell = 0.4;  // m
  using Cell = std::array<int64_t, 3>;
  const auto cell_of = [](const Vec3& p) {
    return Cell{int64_t(std::floor(p.x() / kCell)), int64_t(std::floor(p.y() / kCell)),
                int64_t(std::floor(p.z() / kCell))};
  };
  const Pose between = from_pose.inverse() * to_pose;
  std::set<Cell> cells;
  for (const Vec3& p : from) cells.insert(cell_of(p));
  size_t n = 0;
  for (const Vec3& p : to) n += cells.count(cell_of(between * p));
  return to.empty() ? 0 : double(n) / double(to.size());
}

/// Warns where the sensor stands by its poses, and scans fit better if it moves on a straight
/// way.
std::string warning_of_standing(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr size_t kPairs = 4, kSteps = 8;
  constexpr double kStep = 0.4, kBetter = 0.2;  // m from one scan to the next
  if (infos.size() < 2) return "";
  double still = 0;
  std::array<std::array<double, kSteps>, 4> moved{};  // forward, back, left, right
  for (size_t k = 0; k < kPairs; ++k) {
    const size_t a = k * (infos.size() - 1) / kPairs;
    const std::vector<Vec3> from = upper_points(scans.read(a)),
                            to = upper_points(scans.read(a + 1));
    still += overlap(from, {}, to, {}) / kPairs;
    for (size_t way = 0; way < moved.size(); ++way) {
      for (size_t step = 0; step < kSteps; ++step) {
        Vec3 shift = Vec3::Zero();
        shift[way / 2] = (way % 2 ? -kStep : kStep) * double(step + 1);
        moved[way][step] += overlap(from, {}, to, {Eigen::Quaterniond::Identity(), shift}) / kPairs;
      }
    }
  }
  double best = 0, best_m = 0;
  for (const auto& way : moved) {
    const auto most = std::max_element(way.begin(), way.end());
    if (*most <= best) continue;
    best = *most;
    best_m = kStep * double(most - way.begin() + 1);
  }
  if (best < still + kBetter) return "";
  return "by the poses the sensor stands still, and " + text_of("%.0f", 100 * still) +
         " % of a scan's points lie where the next one has some, but " +
         text_of("%.0f", 100 * best) + " % if it moves by " + text_of("%.1f", best_m) +
         " m from scan to scan: are all poses the same?";
}

std::string warning_of_overlap(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr double kPoor = 0.4, kBetter = 0.2, kFast = 5;  // kFast: m from scan to scan
  const std::vector<std::pair<size_t, size_t>> pairs = pairs_of(infos);
  if (pairs.empty()) return warning_of_standing(scans, infos);
  std::array<double, kReadings.size()> fit{};
  bool fast = true;
  for (const auto& [a, b] : pairs) {
    const Vec3 way =
        infos[b].world_from_sensor.translation - infos[a].world_from_sensor.translation;
    fast = fast && way.norm() > kFast * double(b - a);
    const std::vector<Vec3> from = upper_points(scans.read(a)), to = upper_points(scans.read(b));
    for (size_t k = 0; k < kReadings.size(); ++k) {
      const auto& pose_of = kReadings[k].pose;
      fit[k] += overlap(from, pose_of(infos[a].world_from_sensor), to,
                        pose_of(infos[b].world_from_sensor)) /
                double(pairs.size());
    }
  }
  // Circles on flat ground fit each other best without any motion, so it alone shows no mm.
  if (!fast) fit.back() = 0;
  const size_t best = size_t(std::max_element(fit.begin(), fit.end()) - fit.begin());
  if (fit[0] > kPoor || fit[best] < fit[0] + kBetter) return "";
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

/// Warns where up to four scans have level ground as the sensor has it, and not by the poses.
std::string warning_of_ground(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  constexpr size_t kScans = 4;
  constexpr double kPoor = 0.5, kLevel = 0.4;  // of the level cells without rotations; of all
  double given = 0, upright = 0, all = 0;
  for (size_t k = 0; k < kScans; ++k) {
    const size_t i = k * infos.size() / kScans;
    const PointScan scan = scans.read(i);
    given += level_pairs(scan, infos[i].world_from_sensor.rotation).first;
    const auto [level, pairs] = level_pairs(scan, Eigen::Quaterniond::Identity());
    upright += level;
    all += pairs;
  }
  if (all == 0 || upright < kLevel * all || given > kPoor * upright) return "";
  return "by the poses the ground is steep or above the sensor, and it is level without their "
         "rotations: are they poses of a camera or of another frame, or is w the first of their "
         "quaternions' numbers?";
}

}  // namespace

bool are_tilted(const std::vector<ScanInfo>& scans) {
  constexpr double kTilted = 0.8, kMost = 0.8;  // cosine; of the poses
  const auto tilted = std::ranges::count_if(scans, [](const ScanInfo& scan) {
    return (scan.world_from_sensor.rotation * Vec3::UnitZ()).z() < kTilted;
  });
  return tilted > 0 && double(tilted) >= kMost * double(scans.size());
}

std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans) {
  std::vector<std::string> out;
  for (std::string w : {warning_of_speed(scans), warning_of_climb(scans), warning_of_tilt(scans)}) {
    if (!w.empty()) out.push_back(std::move(w));
  }
  return out;
}

std::string warning_of_scans(ScanSource& scans, const std::vector<ScanInfo>& infos) {
  const std::string ground = are_tilted(infos) ? warning_of_ground(scans, infos) : "";
  return ground.empty() ? warning_of_overlap(scans, infos) : ground;
}

}  // namespace underbrush::pipeline
