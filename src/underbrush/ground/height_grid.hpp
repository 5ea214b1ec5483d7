/// \file
/// A smooth surface through ground points that come as a stream. Its memory grows with the area,
/// not with the number of points. Grids of different tiles can be merged.
#pragma once
#include <memory>
#include <span>

#include "underbrush/ground/height_grid_options.hpp"
#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

struct HeightSums;
struct SparseSums;

/// Collects the normal equations of the surface h that minimises
///
///     Σ_points (h(x, y) − z)² + λ ∫ h_xx² + 2 h_xy² + h_yy² dA,
///
/// where h is bilinear between nodes and the second derivatives are second differences. It is a
/// thin plate on a grid and takes the place of [tallavajhula18]'s regularised radial basis
/// functions.
class HeightGrid {
 public:
  /// Node (0, 0) lies at `origin` (m, world), which should be near the points. Throws
  /// `std::invalid_argument` for a spacing or smoothness that is not positive, or a negative
  /// padding or bridge.
  explicit HeightGrid(const Vec3& origin, const HeightGridOptions& options = {});
  HeightGrid(HeightGrid&&) noexcept;
  HeightGrid& operator=(HeightGrid&&) noexcept;
  ~HeightGrid();

  /// Adds ground points (m, world). Throws `std::invalid_argument` for a point that is not finite
  /// or lies more than 2²⁸ nodes from the origin.
  void add(std::span<const Vec3> points);
  /// Adds the points of `other`. Sums are taken in the order of the calls, so grids must be merged
  /// in a fixed order for the same bits. Throws `std::invalid_argument` if the origins or options
  /// differ.
  void merge(const HeightGrid& other);
  /// Adds points whose sums were kept: `sums` of a grid of the same origin and options.
  void merge(const SparseSums& kept);
  /// Returns the sums of the points added so far.
  SparseSums sums() const;
  /// Returns the number of points added so far.
  size_t points() const;

  /// Solves for the surface by conjugate gradients (incomplete Cholesky) to a relative residual of
  /// 1e-10. Without points the surface is empty. `sigma_m` follows from the normal equations,
  /// without a second pass over the points.
  HeightMap solve() const;

 private:
  std::unique_ptr<HeightSums> sums_;
};

}  // namespace underbrush::ground
