/// \file
/// A smooth surface through ground points that come in a stream. Memory follows the area, not the
/// number of points; grids of different tiles merge.
#pragma once
#include <memory>
#include <span>

#include "underbrush/ground/height_map.hpp"

namespace underbrush::ground {

/// Parameters of `HeightGrid`.
struct HeightGridOptions {
  double spacing_m = 0.5;       ///< Distance s of the nodes.
  double smoothness_m2 = 0.05;  ///< λ: how much bending counts against misfit.
  double padding_m = 1.5;  ///< Nodes exist this far around a point ([tallavajhula18]'s code) ...
  double bridge_m = 10;    ///< ... and across gaps up to this width: ground under crowns and in
                           ///< shadows, which other beams will meet. The authors keep triangles
                           ///< with sides up to 10 m to the same end.
};

/// Normal equations of the surface h that minimises
///
///     Σ_points (h(x, y) − z)² + λ ∫ h_xx² + 2 h_xy² + h_yy² dA,
///
/// h bilinear between nodes, second derivatives by second differences: a thin plate on a grid,
/// which does the work of [tallavajhula18]'s regularised radial basis functions.
class HeightGrid {
 public:
  /// Node (0, 0) lies at `origin` (m, world), which should be near the points. Throws
  /// `std::invalid_argument` for a spacing or smoothness that is not positive, or a negative
  /// padding or bridge.
  explicit HeightGrid(const Vec3& origin, const HeightGridOptions& options = {});
  HeightGrid(HeightGrid&&) noexcept;
  HeightGrid& operator=(HeightGrid&&) noexcept;
  ~HeightGrid();

  /// Adds ground points (m, world). Throws `std::invalid_argument` for one that is not finite or
  /// lies more than 2²⁸ nodes away.
  void add(std::span<const Vec3> points);
  /// Adds what `other` holds. Throws `std::invalid_argument` if its origin or options differ. Sums
  /// in the order of the calls: merge in a fixed order for the same bits.
  void merge(const HeightGrid& other);
  /// Number of points so far.
  size_t points() const;

  /// The surface, by conjugate gradients (incomplete Cholesky) to a relative residual of 1e-10.
  /// Empty without points. `sigma_m` falls out of the normal equations without a second pass.
  HeightMap solve() const;

 private:
  struct Sums;
  std::unique_ptr<Sums> sums_;
};

}  // namespace underbrush::ground
