#include "underbrush/metrics/repeats.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/median.hpp"
#include "underbrush/metrics/scan_pairs.hpp"

namespace underbrush::metrics {
namespace {

/// Returns the chosen beams with directions in the sensor's frame.
BeamLog in_sensor_frame(const BeamLog& scan, const std::vector<bool>& chosen) {
  BeamLog out;
  if (scan.empty()) return out;
  const Mat3f turn = sensor_from_world(scan.info, scan.scan[0]).cast<float>();
  out.info = scan.info;
  out.reserve(scan.size());
  for (size_t i = 0; i < scan.size(); ++i) {
    if (!chosen.empty() && !chosen[i]) continue;
    out.append(scan, i);
    out.direction.back() = turn * out.direction.back();
  }
  return out;
}

BearingRangeHistogram sum_of(const BearingRangeHistogram& a, const BearingRangeHistogram& b) {
  BearingRangeHistogram out = a;
  out.add(b);
  return out;
}

double distance_of(const BearingRangeHistogram& a, const BearingRangeHistogram& b) {
  return a.total() > 0 && b.total() > 0 ? bhattacharyya_distance(a, b) : NAN;
}

}  // namespace

RepeatedScans::RepeatedScans(const RepeatOptions& options)
    : options_(options),
      histogram_{{BearingRangeHistogram(options.bins), BearingRangeHistogram(options.bins)},
                 {BearingRangeHistogram(options.bins), BearingRangeHistogram(options.bins)}} {}

void RepeatedScans::add(const BeamLog& real, const BeamLog& simulated,
                        const std::vector<bool>& chosen) {
  const size_t odd = ranges_[0].size() % 2;
  for (const int side : {0, 1}) {
    BeamLog beams = in_sensor_frame(side == 0 ? real : simulated, chosen);
    // Both logs are of the same beams, but a volumetric draw turns the simulated directions.
    if (side == 1) beams.direction = in_sensor_frame(real, chosen).direction;
    histogram_[side][odd].add(beams);
    Ranges ranges;
    for (size_t i = 0; i < beams.size(); ++i) {
      const Vec3f& d = beams.direction[i];
      const auto bearing = std::lround(std::atan2(d.y(), d.x()) / options_.bins.bearing_rad);
      ranges.emplace(uint32_t(beams.ring[i]) << 16 | uint32_t(uint16_t(bearing)), beams.range_m[i]);
    }
    ranges_[side].push_back(std::move(ranges));
  }
}

double RepeatedScans::median_difference(const std::vector<Ranges>& scans, size_t apart,
                                        size_t* pairs) {
  std::vector<float> difference;
  for (size_t s = 0; s + apart < scans.size() && apart > 0; ++s) {
    for (const auto& [direction, range] : scans[s]) {
      const auto other = scans[s + apart].find(direction);
      if (other == scans[s + apart].end()) continue;
      if (pairs) ++*pairs;
      if (range == kMiss || other->second == kMiss) continue;
      difference.push_back(std::abs(range - other->second));
    }
  }
  return double(median(std::move(difference), std::nanf("")));
}

Repeats RepeatedScans::finish() const {
  Repeats out;
  out.scans = ranges_[0].size();
  out.real_difference_m = median_difference(ranges_[0], 1, &out.directions);
  out.difference_m = median_difference(ranges_[1], 1, nullptr);
  out.real_far_difference_m = median_difference(ranges_[0], out.scans / 2, nullptr);
  out.far_difference_m = median_difference(ranges_[1], out.scans / 2, nullptr);
  const auto& real = histogram_[0];
  const auto& simulated = histogram_[1];
  out.distance = 0.5 * (distance_of(real[0], simulated[1]) + distance_of(real[1], simulated[0]));
  out.floor = distance_of(real[0], real[1]);
  out.same_scans = distance_of(sum_of(real[0], real[1]), sum_of(simulated[0], simulated[1]));
  return out;
}

Repeats repeats(BeamSource& real, BeamSource& simulated, const RepeatOptions& options) {
  RepeatedScans scans(options);
  for_each_scan(real, simulated, [&](const BeamLog& a, const BeamLog& b) { scans.add(a, b); });
  return scans.finish();
}

}  // namespace underbrush::metrics
