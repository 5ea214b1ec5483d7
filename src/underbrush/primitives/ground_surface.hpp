/// \file
/// Heights of a ground that is given as triangles.
#pragma once
#include <optional>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::primitives {

/// Finds heights of the ground mesh of a model, by a grid over its triangles. The model must
/// outlive it.
class GroundSurface {
 public:
  /// Throws `std::invalid_argument` where the model has no ground triangles.
  explicit GroundSurface(const elements::Model& model);

  /// Returns the world z at world (x, y) on the highest triangle there; nothing off the mesh.
  std::optional<double> at(double x, double y) const;
  /// Returns the bounding box of the mesh seen from above (m, world).
  const Eigen::AlignedBox2d& bounds() const { return bounds_; }

 private:
  const elements::Model& model_;
  Eigen::AlignedBox2d bounds_;
  double cell_m_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<uint32_t> begin_, triangle_;  // Triangles of each cell, one cell after another.
};

}  // namespace underbrush::primitives
