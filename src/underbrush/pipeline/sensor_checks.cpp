#include "underbrush/pipeline/sensor_checks.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/check_values.hpp"
#include "underbrush/sensor/ring_numbers.hpp"
#include "underbrush/sensor/rings.hpp"

namespace underbrush::pipeline {
namespace {

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

void check_sensor_of(const std::string& source, const std::string& option, const PointScan& scan,
                     const sensor::Sensor& sensor) {
  constexpr double kBeyond = 0.08, kShare = 0.2, kNear = 0.65;
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
  if (double(fit.beyond) > kBeyond * double(fit.returns)) {
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

void check_channels_of(const std::string& source, const std::string& option, const PointScan& scan,
                       const sensor::Sensor& sensor, double fault_rad) {
  constexpr size_t kFewest = 3;
  constexpr double kShare = 0.2, kShift = 0.5 * M_PI / 180;
  if (!scan.ring.empty() && sensor::rings_are_numbered(scan, sensor.channels.size()) &&
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

}  // namespace underbrush::pipeline
