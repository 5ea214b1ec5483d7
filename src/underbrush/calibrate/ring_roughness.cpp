#include "underbrush/calibrate/ring_roughness.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::calibrate {

void RingRoughness::add(const BeamLog& beams, std::span<const uint8_t> groups) {
  const std::vector<bool> begins = begins_beam(beams);
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!begins[i]) continue;
    Last& last = last_[beams.ring[i]];
    if (last.scan != beams.scan[i]) last = {beams.scan[i], {}, {kMiss, kMiss}};
    const float range = beams.is_hit(i) ? beams.range_m[i] : kMiss;
    const uint8_t group = groups.empty() ? 0 : groups[i];
    const auto hit = [](float r) { return r != kMiss; };
    if (hit(range) && hit(last.range_m[0]) && hit(last.range_m[1])) {
      const uint8_t highest = std::max({group, last.group[0], last.group[1]});
      if (differences_.size() <= highest) differences_.resize(size_t(highest) + 1);
      differences_[highest].push_back(std::abs(range - 2 * last.range_m[0] + last.range_m[1]));
    }
    last.range_m[1] = last.range_m[0];
    last.group[1] = last.group[0];
    last.range_m[0] = range;
    last.group[0] = group;
  }
}

size_t RingRoughness::count(uint8_t group) const {
  return group < differences_.size() ? differences_[group].size() : 0;
}

double RingRoughness::quantile(double q, uint8_t group) const {
  if (count(group) == 0) return NAN;
  std::vector<float> d = differences_[group];
  const auto at = d.begin() + ptrdiff_t(q * double(d.size() - 1));
  std::nth_element(d.begin(), at, d.end());
  return double(*at);
}

double RingRoughness::geometric_mean(uint8_t group) const {
  if (count(group) == 0) return NAN;
  constexpr double kFloor = 0.005;  // m
  double sum = 0;
  for (const float d : differences_[group]) sum += std::log(double(d) + kFloor);
  return std::exp(sum / double(count(group))) - kFloor;
}

}  // namespace underbrush::calibrate
