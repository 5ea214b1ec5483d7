#include "underbrush/credit/crossing_beams.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::credit {
namespace {

constexpr double kCellM = 4;

}  // namespace

GroundArea::GroundArea(const Eigen::Vector2d& low, const Eigen::Vector2d& high) : low_(low) {
  const Eigen::Vector2d extent = (high - low) / kCellM;
  require(extent.minCoeff() >= 0 && extent.prod() < double(1 << 30),
          "update: the area is too large");
  columns_ = int(extent.x()) + 1;
  rows_ = int(extent.y()) + 1;
  in_.resize(size_t(columns_) * size_t(rows_));
}

void GroundArea::add(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d a = (low - low_) / kCellM, b = (high - low_) / kCellM;
  const int x0 = int(std::floor(std::clamp(a.x(), 0.0, double(columns_))));
  const int y0 = int(std::floor(std::clamp(a.y(), 0.0, double(rows_))));
  const int x1 = int(std::floor(std::clamp(b.x(), -1.0, columns_ - 1.0)));
  const int y1 = int(std::floor(std::clamp(b.y(), -1.0, rows_ - 1.0)));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) in_[size_t(y) * size_t(columns_) + size_t(x)] = 1;
  }
}

// Walks from cell to cell, always across the nearer of the borders ahead.
bool GroundArea::is_crossed(const Eigen::Vector2d& from, const Eigen::Vector2d& step) const {
  const Eigen::Vector2d a = (from - low_) / kCellM, d = step / kCellM;
  // The part of the way within the bounds, as shares of it.
  double begin = 0, end = 1;
  const double size[2] = {double(columns_), double(rows_)};
  for (int axis = 0; axis < 2; ++axis) {
    if (d[axis] == 0) {
      if (a[axis] < 0 || a[axis] >= size[axis]) return false;
      continue;
    }
    const double t0 = -a[axis] / d[axis], t1 = (size[axis] - a[axis]) / d[axis];
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  }
  if (!(begin <= end)) return false;
  const Eigen::Vector2d start = a + begin * d;
  int cell[2], stride[2];
  double next[2], each[2];
  for (int axis = 0; axis < 2; ++axis) {
    cell[axis] = std::clamp(int(std::floor(start[axis])), 0, int(size[axis]) - 1);
    stride[axis] = d[axis] < 0 ? -1 : 1;
    each[axis] = d[axis] == 0 ? INFINITY : 1 / std::abs(d[axis]);
    const double border = cell[axis] + (d[axis] < 0 ? 0 : 1);
    next[axis] = d[axis] == 0 ? INFINITY : (border - a[axis]) / d[axis];
  }
  for (;;) {
    if (in_[size_t(cell[1]) * size_t(columns_) + size_t(cell[0])]) return true;
    const int axis = next[0] < next[1] ? 0 : 1;
    if (!(next[axis] <= end)) return false;
    cell[axis] += stride[axis];
    if (cell[axis] < 0 || cell[axis] >= int(size[axis])) return false;
    next[axis] += each[axis];
  }
}

std::vector<uint8_t> meet_something(const trace::World& world, std::span<const Ray> rays,
                                    std::span<const double> reach_m) {
  trace::IntersectionLists met;
  world.all_intersections(rays, {0, HUGE_VAL}, reach_m, met);
  std::vector<uint8_t> out(rays.size());
  // The lists are sorted by range, and what lies beyond the reach may be in them or not.
  for (size_t i = 0; i < rays.size(); ++i) {
    out[i] = !met[i].empty() && met[i].front().t_m <= reach_m[i];
  }
  return out;
}

BeamLog CrossingBeams::crossing(const BeamLog& chunk) const {
  const double farthest = std::min(chunk.info.max_range_m, max_range_m_);
  std::vector<uint8_t> crosses(chunk.size());
  parallel_for(chunk.size(), 8192, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double length = std::min(double(chunk.range_m[i]) + beyond_m_, farthest);
      const Vec3 from = chunk.origin[i] - origin_,
                 step = length * chunk.direction[i].cast<double>();
      crosses[i] = area_.is_crossed(from.head<2>(), step.head<2>());
    }
  });
  BeamLog out = chunk.like();
  for (size_t begin = 0, end = 0; begin < chunk.size(); begin = end) {
    for (end = begin + 1; end < chunk.size() && crosses[end] == crosses[begin];) ++end;
    if (crosses[begin]) out.append(chunk, begin, end);
  }
  return out;
}

bool CrossingBeams::next(BeamLog& chunk) {
  while (source_.next(chunk)) {
    chunk = crossing(chunk);
    if (!chunk.empty()) return true;
  }
  return false;
}

bool BeamsBeside::next(BeamLog& chunk) {
  for (BeamLog all; source_.next(all);) {
    std::vector<Ray> rays;
    std::vector<double> reach_m;
    for (size_t i = 0; i < all.size(); ++i) {
      rays.push_back(all.ray(i));
      const double end = all.is_hit(i) ? double(all.range_m[i]) + beyond_m_ : HUGE_VAL;
      reach_m.push_back(std::min(end, all.info.max_range_m));
    }
    const std::vector<uint8_t> meets = meet_something(world_, rays, reach_m);
    chunk = all.like();
    for (size_t i = 0; i < all.size(); ++i) {
      if (!meets[i]) chunk.append(all, i);
    }
    if (!chunk.empty()) return true;
  }
  return false;
}

size_t JoinedBeams::size() const {
  size_t sum = 0;
  for (const BeamSource* source : sources_) sum += source->size();
  return sum;
}

void JoinedBeams::rewind() {
  at_ = 0;
  for (BeamSource* source : sources_) source->rewind();
}

bool JoinedBeams::next(BeamLog& chunk) {
  for (; at_ < sources_.size(); ++at_) {
    if (sources_[at_]->next(chunk)) return true;
  }
  chunk = {};
  return false;
}

}  // namespace underbrush::credit
