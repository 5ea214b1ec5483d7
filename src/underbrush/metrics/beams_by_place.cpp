#include "underbrush/metrics/beams_by_place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace underbrush::metrics {

Vec3 direction_from(const Vec3& place, const BeamLog& log, uint32_t i) {
  if (!log.is_hit(i)) return log.direction[i].cast<double>();
  return (log.end_point(i) - place).normalized();
}

BeamsByPlace::BeamsByPlace(const BeamLog& log, std::vector<uint32_t> rows)
    : log_(log), rows_(std::move(rows)) {
  constexpr double kSide = 2;  // m
  std::map<std::array<int64_t, 3>, Cell> cells;
  for (uint32_t k = 0; k < rows_.size(); ++k) {
    const uint32_t i = rows_[k];
    if (!log.is_hit(i)) {
      misses_.push_back(k);
      continue;
    }
    const Vec3 end = log.end_point(i), at = (end - log.origin[rows_[0]]) / kSide;
    Cell& cell = cells[{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())}];
    cell.box.extend(end);
    cell.beams.push_back(k);
    cell.ends.push_back(end);
  }
  cells_.reserve(cells.size());
  for (auto& [key, cell] : cells) cells_.push_back(std::move(cell));
}

SeenBeams BeamsByPlace::seen_from(const Vec3& place, const Eigen::AlignedBox3f& box) const {
  std::vector<std::pair<uint32_t, Vec3f>> seen;
  const auto look_at = [&](uint32_t k, const Vec3& along) {
    const Vec3f direction = along.cast<float>();
    if (box.contains(direction)) seen.emplace_back(k, direction);
  };
  for (const uint32_t k : misses_) look_at(k, direction_from(place, log_, rows_[k]));
  for (const Cell& cell : cells_) {
    if (!may_be_within(cell, place, box)) continue;
    for (size_t i = 0; i < cell.beams.size(); ++i)
      look_at(cell.beams[i], (cell.ends[i] - place).normalized());
  }
  std::sort(seen.begin(), seen.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  SeenBeams out;
  out.row.reserve(seen.size());
  out.direction.reserve(seen.size());
  for (const auto& [k, direction] : seen) {
    out.row.push_back(rows_[k]);
    out.direction.push_back(direction);
  }
  return out;
}

/// False where the directions from `place` to a ball around a cell are all outside of `box`. A
/// direction to a ball of radius r at the distance d is at most sqrt(2) r/d (a chord) from that to
/// its centre, where r < d.
bool BeamsByPlace::may_be_within(const Cell& cell, const Vec3& place,
                                 const Eigen::AlignedBox3f& box) {
  const Vec3 to = cell.box.center() - place;
  const double away = to.norm(), radius = 0.5 * cell.box.diagonal().norm();
  if (away <= radius) return true;
  const double reach = 1.4143 * radius / away + 1e-6;  // And the rounding of 32-bit directions.
  return box.cast<double>().exteriorDistance((to / away).eval()) <= reach;
}

}  // namespace underbrush::metrics
