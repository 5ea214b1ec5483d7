/// \file
/// This file has the neighbourhoods of ellipsoids, whose shapes and densities are the priors of the
/// ellipsoids in them.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::likelihood {

/// The number of ellipsoids of a neighbourhood.
inline constexpr size_t kNeighbourhood = 7;

/// The beams that ended in an ellipsoid, and the path that beams took through its matter.
struct Evidence {
  double hits = 0;    ///< Σ r, the soft hits.
  double path_m = 0;  ///< Path, weighted by the ellipsoid's profile, m; hits / path estimates κ.
};

/// The prior of an ellipsoid.
struct Neighbourhood {
  Mat3 shape = Mat3::Zero();  ///< Σ₀, m².
  double density_per_m = 0;   ///< κ₀, 1/m; 0 where no beam passed the neighbourhood.
};

/// The neighbours of each ellipsoid: the `kNeighbourhood` with the nearest means, itself
/// among them. They are found once, because a refinement moves means by less than they are
/// apart.
class Neighbours {
 public:
  explicit Neighbours(std::span<const elements::Ellipsoid> ellipsoids);

  /// Computes the neighbourhood of each ellipsoid, of which there are as many as before. With its
  /// neighbours (μ_j, Σ_j) and their evidence it is
  ///
  ///     Σ₀ ∝ Σ_j Σ_j + (μ_j − μ)(μ_j − μ)ᵀ,        κ₀ = Σ_j hits_j / Σ_j path_j.
  ///
  /// Σ₀ has the trace of the ellipsoid's own covariance: it is flat on a wall, long along a trunk
  /// and round in a crown. κ₀ is the maximum-likelihood density of a neighbourhood of even matter,
  /// so that the mean density of a turbid medium stays unbiased. The result has the same bits for
  /// any number of threads.
  std::vector<Neighbourhood> neighbourhoods(std::span<const elements::Ellipsoid> ellipsoids,
                                            std::span<const Evidence> evidence) const;

 private:
  std::vector<std::array<uint32_t, kNeighbourhood>> near_;
  size_t count_ = 0;  // neighbours of each; fewer where there are fewer ellipsoids
};

}  // namespace underbrush::likelihood
