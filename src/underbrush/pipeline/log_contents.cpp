#include "underbrush/pipeline/log_contents.hpp"

#include <algorithm>

#include "underbrush/sensor/sensor.hpp"

namespace underbrush::pipeline {
namespace {

constexpr double kNearM = 1000, kNearStepM = 0.01, kFarStepM = 1;
constexpr size_t kNearBins = 100000, kFarBins = 20000;

size_t bin_of(double range_m) {
  if (range_m < kNearM) return std::min(kNearBins - 1, size_t(range_m / kNearStepM));
  return kNearBins + size_t(std::min((range_m - kNearM) / kFarStepM, double(kFarBins - 1)));
}

}  // namespace

void LogContents::add(const BeamLog& log) {
  ranges.resize(kNearBins + kFarBins);
  const std::vector<bool> begins = begins_beam(log);
  for (size_t i = 0; i < log.size(); ++i) {
    beams += begins[i];
    if (log.is_hit(i)) {
      hits += begins[i];
      ++echoes;
      const Vec3 end = log.end_point(i);
      low = low.cwiseMin(end);
      high = high.cwiseMax(end);
      ++ranges[bin_of(double(log.range_m[i]))];
      low_intensity = std::min(low_intensity, double(log.intensity[i]));
      high_intensity = std::max(high_intensity, double(log.intensity[i]));
    } else {
      ++(log.flags[i] & kInferred ? inferred : recorded);
    }
    first_s = std::min(first_s, log.time_s[i]);
    last_s = std::max(last_s, log.time_s[i]);
    if (i == 0 || log.scan[i] != log.scan[i - 1]) scans.insert(log.scan[i]);
    if (i == 0 || log.ring[i] != log.ring[i - 1]) rings.insert(log.ring[i]);
  }
  extra.clear();
  for (const auto& [name, column] : log.extra) extra.push_back(name);
}

double LogContents::range_percentile(double share) const {
  size_t sum = 0;
  for (size_t b = 0; b < ranges.size(); ++b) {
    sum += ranges[b];
    if (double(sum) < share * double(echoes)) continue;
    return b < kNearBins ? (double(b) + 0.5) * kNearStepM
                         : kNearM + (double(b - kNearBins) + 0.5) * kFarStepM;
  }
  return 0;
}

std::vector<std::string> sensor_guess(const LogInfo& info, size_t rings) {
  if (!info.sensor.empty()) return {info.sensor};
  std::vector<std::string> names;
  for (const std::string& name : sensor::names()) {
    if (rings > 1 && sensor::load(name).channels.size() == rings) names.push_back(name);
  }
  return names;
}

}  // namespace underbrush::pipeline
