/// \file
/// A smooth surface made of one plane for each cell of a grid, and the fit of such a plane.
#pragma once
#include <algorithm>
#include <vector>

namespace underbrush::ground {

/// A grid of planes z = h + gx (x − cx) + gy (y − cy) about the centres (cx, cy) of its cells.
/// Between centres the planes are blended bilinearly.
struct PlaneGrid {
  /// Height (m) and gradient at a cell's centre.
  struct Plane {
    double h = 0, gx = 0, gy = 0;
  };
  int nx = 0, ny = 0;  ///< Numbers of cells along x and along y.
  double cell_m = 0;   ///< m; side of a cell.
  std::vector<Plane> planes;

  PlaneGrid() = default;
  /// Makes level `level` of a pyramid over `fine_nx` × `fine_ny` cells of side `fine_cell_m`: its
  /// cells are 2^level times as long.
  PlaneGrid(int fine_nx, int fine_ny, double fine_cell_m, int level)
      : nx((fine_nx - 1) / (1 << level) + 1),
        ny((fine_ny - 1) / (1 << level) + 1),
        cell_m(fine_cell_m * (1 << level)),
        planes(size_t(nx) * size_t(ny)) {}

  /// Returns height and gradient at (x, y) (m, from the grid's corner), extrapolated beyond the
  /// outer centres.
  Plane at(double x, double y) const {
    const double u = x / cell_m - 0.5, v = y / cell_m - 0.5;
    const int i = std::clamp(int(u), 0, std::max(0, nx - 2));
    const int j = std::clamp(int(v), 0, std::max(0, ny - 2));
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

  /// Adds a point, relative to the centre.
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
  // The system is solved for the change from the prior. Its matrix L D Lᵀ is positive definite by
  // the prior's weight, so that no pivot is needed.
  const double b0 = m.z - m.w * prior.h - m.x * prior.gx - m.y * prior.gy;
  const double b1 = m.xz - m.x * prior.h - m.xx * prior.gx - m.xy * prior.gy;
  const double b2 = m.yz - m.y * prior.h - m.xy * prior.gx - m.yy * prior.gy;
  const double d0 = m.w + weight, l10 = m.x / d0, l20 = m.y / d0;
  const double d1 = m.xx + gradient_weight - l10 * m.x, l21 = (m.xy - l10 * m.y) / d1;
  const double d2 = m.yy + gradient_weight - l20 * m.y - l21 * l21 * d1;
  const double y1 = b1 - l10 * b0, y2 = b2 - l20 * b0 - l21 * y1;
  const double s2 = y2 / d2, s1 = y1 / d1 - l21 * s2, s0 = b0 / d0 - l10 * s1 - l20 * s2;
  return {prior.h + s0, prior.gx + s1, prior.gy + s2};
}

}  // namespace underbrush::ground
