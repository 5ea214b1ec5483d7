/// \file
/// The field's own estimator of plant area density, straight from a log: hits over path length in
/// each cell of 1 m, with the correction of its bias and a confidence interval [pimont18].
#pragma once
#include <vector>

#include "studies/turbid_slab.hpp"

namespace underbrush::studies {

/// The sums over the beams of a log in one cell. Path lengths are free paths, up to the hit, each
/// times the projection G of its beam (m).
struct CellSums {
  size_t beams = 0;  ///< Number of beams that reached the cell.
  size_t hits = 0;
  double path_m = 0;          ///< Sum over all beams.
  double path_of_hits_m = 0;  ///< Sum over beams that were hit in the cell.

  /// Returns the area density (m²/m³): the maximum of the likelihood, hits / path, less its bias,
  ///
  ///     (hits − path of hits / path) / path   [pimont18].
  ///
  /// NaN if no beam reached the cell.
  double density() const;
  /// Whether the 95 % interval holds this density: by the score test (hits − d · path)² ≤ 1.96² · d
  /// · path, the variance of the hits being d · path. The test keeps its level where hits are few.
  bool interval_holds(double density) const;
};

/// The cells of a slab, each side 1 m.
class SlabCells {
 public:
  static constexpr int kWidth = int(2 * TurbidSlab::kHalfWidthM);
  static constexpr int kHeight = int(TurbidSlab::kHighM - TurbidSlab::kLowM);

  /// Counts the beams of a log. The leaf angles are known.
  SlabCells(const BeamLog& log, LeafAngles angles);

  /// The cell with the lower corner (x − 20, y − 20, z + 4) m.
  const CellSums& at(int x, int y, int z) const { return cell_[index(x, y, z)]; }
  /// Returns the mean share of beams that pass all cells: e^−Σ(density · G · path). A cell that no
  /// beam reached has the mean of its layer.
  double transmission(const BeamLog& beams) const;

 private:
  static size_t index(int x, int y, int z) { return size_t((z * kWidth + y) * kWidth + x); }

  LeafAngles angles_;
  std::vector<CellSums> cell_;
};

}  // namespace underbrush::studies
