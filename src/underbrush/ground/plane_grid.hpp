/// \file
/// A smooth surface as a plane for each cell of a grid, and the fit of such a plane.
#pragma once
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::ground {

/// A plane a cell: z = h + gx (x − cx) + gy (y − cy) about the cell's centre; between centres the
/// planes are blended bilinearly.
struct PlaneGrid {
  struct Plane {
    double h = 0, gx = 0, gy = 0;
  };
  int nx = 0, ny = 0;
  double cell_m = 0;
  std::vector<Plane> planes;

  PlaneGrid() = default;
  /// Level `level` of a pyramid over `fine_nx` × `fine_ny` cells of side `fine_cell_m`.
  PlaneGrid(int fine_nx, int fine_ny, double fine_cell_m, int level)
      : nx((fine_nx - 1) / (1 << level) + 1),
        ny((fine_ny - 1) / (1 << level) + 1),
        cell_m(fine_cell_m * (1 << level)),
        planes(size_t(nx) * size_t(ny)) {}

  /// Height and gradient at (x, y), extrapolated beyond the outer centres.
  Plane at(double x, double y) const {
    const double u = x / cell_m - 0.5, v = y / cell_m - 0.5;
    const int i = std::clamp(int(std::floor(u)), 0, std::max(0, nx - 2));
    const int j = std::clamp(int(std::floor(v)), 0, std::max(0, ny - 2));
    const double a = nx > 1 ? std::clamp(u - i, 0.0, 1.0) : 0;
    const double b = ny > 1 ? std::clamp(v - j, 0.0, 1.0) : 0;
    Plane sum;
    for (int k = 0; k < 4; ++k) {
      const double w = (k & 1 ? a : 1 - a) * (k & 2 ? b : 1 - b);
      if (w == 0) continue;
      const int ci = i + (k & 1), cj = j + (k >> 1);
      const Plane& p = planes[size_t(cj) * nx + ci];
      sum.h += w * (p.h + p.gx * (u - ci) * cell_m + p.gy * (v - cj) * cell_m);
      sum.gx += w * p.gx;
      sum.gy += w * p.gy;
    }
    return sum;
  }
};

/// Weighted moments of points about a cell's centre, for the fit of a plane.
struct PlaneMoments {
  double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;

  void add(double px, double py, double pz, double weight) {
    w += weight, x += weight * px, y += weight * py, z += weight * pz;
    xx += weight * px * px, xy += weight * px * py, yy += weight * py * py;
    xz += weight * px * pz, yz += weight * py * pz;
  }
  /// Adds `k` times the moments `m` of a cell whose centre lies (dx, dy) away.
  void add(const PlaneMoments& m, double dx, double dy, double k) {
    w += k * m.w, x += k * (m.x + dx * m.w), y += k * (m.y + dy * m.w), z += k * m.z;
    xx += k * (m.xx + 2 * dx * m.x + dx * dx * m.w);
    xy += k * (m.xy + dx * m.y + dy * m.x + dx * dy * m.w);
    yy += k * (m.yy + 2 * dy * m.y + dy * dy * m.w);
    xz += k * (m.xz + dx * m.z), yz += k * (m.yz + dy * m.z);
  }
};

/// argmin over planes of Σ w (z − plane)² + prior weight · (distance from the prior plane)².
inline PlaneGrid::Plane fit_plane(const PlaneMoments& m, const PlaneGrid::Plane& prior,
                                  double weight, double cell_m) {
  const double gradient_weight = weight * cell_m * cell_m;
  Mat3 a;
  a << m.w + weight, m.x, m.y, m.x, m.xx + gradient_weight, m.xy, m.y, m.xy, m.yy + gradient_weight;
  // Solved for the change from the prior.
  const Vec3 p(prior.h, prior.gx, prior.gy);
  const Vec3 b(m.z - m.w * p[0] - m.x * p[1] - m.y * p[2],
               m.xz - m.x * p[0] - m.xx * p[1] - m.xy * p[2],
               m.yz - m.y * p[0] - m.xy * p[1] - m.yy * p[2]);
  const Vec3 s = p + a.ldlt().solve(b);
  return {s[0], s[1], s[2]};
}

}  // namespace underbrush::ground
