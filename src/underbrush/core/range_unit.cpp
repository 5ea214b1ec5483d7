#include "underbrush/core/range_unit.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/median.hpp"

namespace underbrush {

bool RangeUnit::add(const BeamLog& beams) {
  constexpr size_t kEnough = 100000, kMostBeams = 1000000;
  beams_ += beams.size();
  for (size_t i = 0; i < beams.size() && range_m_.size() < kEnough; ++i) {
    if (!beams.is_hit(i)) continue;
    range_m_.push_back(beams.range_m[i]);
    steepness_.push_back(std::abs(beams.direction[i].z()));
  }
  return range_m_.size() < kEnough && beams_ < kMostBeams;
}

std::string RangeUnit::warning() const {
  constexpr float kFar = 1e3f, kFarthest = 10e3f;  // m
  constexpr float kLevel = 0.5f;
  const float half = median(range_m_);
  const auto farther =
      size_t(std::ranges::count_if(range_m_, [](float r) { return r > kFarthest; }));
  const bool level = half > kFar && 100 * farther > range_m_.size() && median(steepness_) < kLevel;
  if (!level && half <= kFarthest) return "";
  return "half of the returns are more than " + std::string(half > kFarthest ? "10" : "1") +
         " km from the sensor: is the log in mm? Then import it with --unit mm";
}

void require_metres(BeamSource& log, const std::string& verb) {
  RangeUnit unit;
  log.rewind();
  for (BeamLog chunk; log.next(chunk) && unit.add(chunk);) {
  }
  log.rewind();
  const std::string warning = unit.warning();
  if (!warning.empty()) throw DataError(verb + ": " + warning);
}

}  // namespace underbrush
