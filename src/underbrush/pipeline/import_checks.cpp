#include "underbrush/pipeline/import_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/sensor/ring_numbers.hpp"
#include "underbrush/sensor/rings.hpp"

namespace underbrush::pipeline {
namespace {

std::string text_of(const char* format, double number) {
  char text[64];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool is_return(const Vec3f& p) { return p.allFinite() && !p.isZero(); }

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

/// How the returns of a scan fit the channels of a sensor.
struct Fit {
  size_t returns = 0, beyond = 0;  ///< beyond: two degrees and more outside its elevations
  size_t between = 0, near = 0;    ///< between channels far apart; near: of these, at one
  size_t far = 0;                  ///< farther than it reaches
  double least = INFINITY, most = -INFINITY;  ///< rad; elevations
};

Fit fit_of(const PointScan& scan, const sensor::Sensor& sensor) {
  constexpr double kBeyond = 2 * M_PI / 180, kGap = 0.8 * M_PI / 180;
  constexpr double kParallax = 5, kReach = 1.5;  // m; of the maximum range
  std::vector<double> channel;
  for (const sensor::Channel& c : sensor.channels) channel.push_back(c.elevation_rad);
  std::sort(channel.begin(), channel.end());
  Fit fit;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p)) continue;
    const double e = std::asin(std::clamp(double(p.z() / p.norm()), -1.0, 1.0));
    ++fit.returns;
    fit.far += double(p.norm()) > kReach * sensor.max_range_m;
    fit.beyond += e < channel.front() - kBeyond || e > channel.back() + kBeyond;
    fit.least = std::min(fit.least, e);
    fit.most = std::max(fit.most, e);
    const auto above = std::upper_bound(channel.begin(), channel.end(), e);
    if (above == channel.begin() || above == channel.end() || p.norm() < kParallax) continue;
    const double gap = *above - above[-1];
    if (gap < kGap) continue;
    ++fit.between;
    fit.near += std::min(*above - e, e - above[-1]) < gap / 4;
  }
  return fit;
}

/// About 6000 of a scan's returns farther than 2 m, without a pattern that rings may share.
std::vector<Vec3f> some_returns(const PointScan& scan) {
  constexpr double kMost = 6000;
  constexpr float kNearest = 2;  // m
  const auto most = uint64_t(kMost / double(std::max<size_t>(scan.size(), 1)) * double(UINT32_MAX));
  std::vector<Vec3f> out;
  for (size_t i = 0; i < scan.size(); ++i) {
    const Vec3f& p = scan.point[i];
    const uint32_t drawn = uint32_t(i) * 2654435761u;
    if (drawn <= most && is_return(p) && p.norm() > kNearest) out.push_back(p);
  }
  return out;
}

/// Channels, in order of their elevation, between the lowest and the highest that have returns, and
/// how many of these have none though the nearest ones on both sides that have some have many.
struct Silence {
  size_t channels = 0, silent = 0;
};

Silence silence_of(const std::vector<Vec3f>& points, const sensor::Sensor& sensor,
                   double fault_rad) {
  constexpr double kNone = 0.02, kMany = 0.25, kFewest = 8;
  std::vector<size_t> order(sensor.channels.size()), count(sensor.channels.size());
  for (size_t c = 0; c < order.size(); ++c) order[c] = c;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return sensor.channels[a].elevation_rad < sensor.channels[b].elevation_rad;
  });
  for (const uint16_t c : sensor::rings_from_elevation(points, sensor, fault_rad)) ++count[c];
  std::vector<double> some;
  for (const size_t n : count) {
    if (n > 0) some.push_back(double(n));
  }
  std::sort(some.begin(), some.end());
  const double full = some.empty() ? 0 : some[some.size() * 3 / 4];
  Silence out;
  if (full < kFewest) return out;
  size_t before = 0, silent = 0;  // The last channel with returns, counted from 1; those since.
  for (size_t k = 0; k < order.size(); ++k) {
    const auto n = double(count[order[k]]);
    if (n <= kNone * full) {
      silent += before > 0;
      continue;
    }
    const bool many =
        before > 0 && n >= kMany * full && double(count[order[before - 1]]) >= kMany * full;
    out.silent += many ? silent : 0;
    out.channels += silent + 1;
    silent = 0;
    before = k + 1;
  }
  return out;
}

}  // namespace

void check_channels_of(const std::string& source, const std::string& option, const PointScan& scan,
                       const sensor::Sensor& sensor, double fault_rad) {
  constexpr size_t kFewest = 3;
  constexpr double kShare = 0.2, kShift = 0.5 * M_PI / 180;
  if (!scan.ring.empty() && sensor::rings_are_told(scan, sensor.channels.size()) &&
      sensor::rings_are_channels(scan.ring, scan.point, sensor, fault_rad)) {
    return;
  }
  const std::vector<Vec3f> points = some_returns(scan);
  Silence least = silence_of(points, sensor, fault_rad);
  const auto wrong = [](const Silence& s) {
    return s.silent >= kFewest && double(s.silent) >= kShare * double(s.channels);
  };
  // The elevations of the data may be off by a little, but not from one channel to the next.
  const double most = std::min(kShift, 0.4 * sensor::channel_spacing(sensor));
  for (int k = 1; wrong(least) && k <= 10; ++k) {
    for (const double fault : {fault_rad - k * most / 10, fault_rad + k * most / 10}) {
      const Silence found = silence_of(points, sensor, fault);
      if (found.silent < least.silent) least = found;
    }
  }
  if (!wrong(least)) return;
  throw FormatError(source, option,
                    in_quotes(sensor.name) +
                        " cannot be its sensor: " + std::to_string(least.silent) + " of its " +
                        std::to_string(sensor.channels.size()) +
                        " channels have no return, though those above and below them do; if rings "
                        "were left out of the scan, name a sensor file with the channels it has");
}

std::string warning_of_greatest_range(const PointScan& scan, double max_range_m) {
  constexpr double kSame = 1e-5, kRounding = 1e-3, kShare = 0.01;
  constexpr size_t kFewest = 20;
  double greatest = 0;
  for (const Vec3f& p : scan.point) {
    if (is_return(p)) greatest = std::max(greatest, p.cast<double>().norm());
  }
  size_t returns = 0, same = 0;
  for (const Vec3f& p : scan.point) {
    if (!is_return(p)) continue;
    ++returns;
    same += p.cast<double>().norm() >= greatest * (1 - kSame) - kRounding;
  }
  if (same < kFewest || double(same) < kShare * double(returns)) return "";
  if (max_range_m > 0 && std::abs(max_range_m - greatest) <= kSame * greatest + kRounding)
    return "";
  const std::string range = text_of("%.6g", greatest);
  return std::to_string(same) + " of " + std::to_string(returns) +
         " returns of the first scan are at its greatest range, " + range +
         " m: are they beams without a return? Then --max-range " + range + " makes them misses";
}

void check_sensor_of(const std::string& source, const std::string& option, const PointScan& scan,
                     const sensor::Sensor& sensor) {
  constexpr double kShare = 0.2, kNear = 0.65;
  constexpr size_t kFewest = 100;
  const auto fail = [&](const std::string& reason) {
    throw FormatError(source, option, in_quotes(sensor.name) + " cannot be its sensor: " + reason);
  };
  const auto percent = [](size_t part, size_t of) {
    return text_of("%.0f", 100 * double(part) / double(of)) + " % of the returns ";
  };
  const size_t channels = sensor.channels.size();
  const Fit fit = fit_of(scan, sensor);
  if (fit.returns < kFewest) return;
  if (!scan.ring.empty()) {
    const size_t highest = *std::max_element(scan.ring.begin(), scan.ring.end());
    if (highest > channels) {  // Rings may count from 1.
      fail("ring " + std::to_string(highest) + " is in it, of " + std::to_string(channels) +
           " channels");
    }
  }
  if (double(fit.beyond) > kShare * double(fit.returns)) {
    fail(percent(fit.beyond, fit.returns) + "lie beyond its elevations; they are at " +
         text_of("%.1f", fit.least / kDegree) + " to " + text_of("%.1f", fit.most / kDegree) +
         " degrees");
  }
  if (fit.between >= kFewest && double(fit.near) < kNear * double(fit.between)) {
    fail("only " + percent(fit.near, fit.between) +
         "lie near the elevations of its channels, where chance has half");
  }
  if (double(fit.far) > kShare * double(fit.returns)) {
    fail(percent(fit.far, fit.returns) + "are farther away than it reaches");
  }
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

size_t coarse_times(const PointScan& scan) {
  constexpr size_t kEnough = 100, kMost = 8;  // points; times
  if (scan.time_s.size() < kEnough) return 0;
  std::set<double> times;
  for (const double t : scan.time_s) {
    if (std::isfinite(t)) times.insert(t);
    if (times.size() > kMost) return 0;
  }
  return times.size();
}

std::string warning_of_ranges(const PointScan& scan) {
  constexpr double kFar = 1000;  // m
  std::vector<double> range;
  for (const Vec3f& p : scan.point) {
    if (is_return(p)) range.push_back(double(p.norm()));
  }
  const double half = median(std::move(range));
  if (half < kFar) return "";
  return "half of the points are " + text_of("%.0f", half) +
         " m and more from the sensor: are they in mm? Then --unit mm";
}

std::vector<std::string> warnings_of_poses(const std::vector<ScanInfo>& scans) {
  std::vector<std::string> out;
  for (std::string w : {warning_of_speed(scans), warning_of_climb(scans), warning_of_tilt(scans)}) {
    if (!w.empty()) out.push_back(std::move(w));
  }
  return out;
}

}  // namespace underbrush::pipeline
