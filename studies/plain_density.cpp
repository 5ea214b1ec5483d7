#include "studies/plain_density.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::studies {
namespace {

/// Calls `visit(cell, length in m)` for each cell of 1 m that the ray crosses between two ranges.
/// The coordinates of a cell are those of its lower corner, counted from the slab's.
template <class Visit>
void for_cells(const Ray& ray, double from_m, double to_m, const Visit& visit) {
  const Vec3 corner(-TurbidSlab::kHalfWidthM, -TurbidSlab::kHalfWidthM, TurbidSlab::kLowM);
  const Eigen::Vector3i last(SlabCells::kWidth - 1, SlabCells::kWidth - 1, SlabCells::kHeight - 1);
  const Vec3 start = ray.at(from_m) - corner;
  const Eigen::Vector3i first = start.array().floor().cast<int>();
  Eigen::Vector3i cell = first.cwiseMax(0).cwiseMin(last);
  for (double at = from_m; at < to_m;) {
    int axis = 0;
    double next = INFINITY;
    for (int d = 0; d < 3; ++d) {
      const double step = ray.direction[d];
      if (step == 0) continue;
      const double wall = corner[d] + cell[d] + (step > 0 ? 1 : 0);
      const double t = (wall - ray.origin[d]) / step;
      if (t < next) {
        next = t;
        axis = d;
      }
    }
    const double end = std::min(next, to_m);
    visit(cell, std::max(0.0, end - at));
    at = std::max(at, end);
    cell[axis] += ray.direction[axis] > 0 ? 1 : -1;
    if (next >= to_m || cell[axis] < 0 || cell[axis] > last[axis]) return;
  }
}

}  // namespace

double CellSums::density() const {
  return path_m > 0 ? (double(hits) - path_of_hits_m / path_m) / path_m : NAN;
}

bool CellSums::interval_holds(double density) const {
  constexpr double kNormal95 = 1.959964;
  const double expected = density * path_m;
  return std::pow(double(hits) - expected, 2) <= kNormal95 * kNormal95 * expected;
}

SlabCells::SlabCells(const BeamLog& log, LeafAngles angles)
    : angles_(angles), cell_(size_t(kWidth * kWidth * kHeight)) {
  for (size_t i = 0; i < log.size(); ++i) {
    const Ray ray = log.ray(i);
    const auto crossing = TurbidSlab::crossing(ray);
    if (!crossing || log.range_m[i] <= crossing->enter_m) continue;
    const bool hit = double(log.range_m[i]) < crossing->leave_m;
    const double g = projection(angles, ray.direction);
    CellSums* end = nullptr;
    double path_in_end = 0;
    for_cells(ray, crossing->enter_m, hit ? double(log.range_m[i]) : crossing->leave_m,
              [&](const Eigen::Vector3i& c, double length) {
                end = &cell_[index(c.x(), c.y(), c.z())];
                path_in_end = g * length;
                ++end->beams;
                end->path_m += path_in_end;
              });
    if (!hit || !end) continue;
    ++end->hits;
    end->path_of_hits_m += path_in_end;
  }
}

double SlabCells::transmission(const BeamLog& beams) const {
  std::vector<double> layer(kHeight), density(cell_.size());
  for (int z = 0; z < kHeight; ++z) {
    double path = 0;
    for (size_t k = index(0, 0, z); k < index(0, 0, z + 1); ++k) {
      layer[size_t(z)] += double(cell_[k].hits);
      path += cell_[k].path_m;
    }
    layer[size_t(z)] /= path;
    for (size_t k = index(0, 0, z); k < index(0, 0, z + 1); ++k) {
      density[k] = cell_[k].path_m > 0 ? cell_[k].density() : layer[size_t(z)];
    }
  }
  double sum = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    const Ray ray = beams.ray(i);
    const auto crossing = TurbidSlab::crossing(ray);
    double depth = 0;
    if (crossing) {
      for_cells(ray, crossing->enter_m, crossing->leave_m,
                [&](const Eigen::Vector3i& c, double length) {
                  depth += density[index(c.x(), c.y(), c.z())] * length;
                });
    }
    sum += std::exp(-projection(angles_, ray.direction) * depth);
  }
  return sum / double(beams.size());
}

}  // namespace underbrush::studies
