/// \file
/// The roughness spectrum of a ground, and grounds that have it.
#pragma once
#include <vector>

#include "underbrush/primitives/ground_surface.hpp"

namespace underbrush::sites {

/// The heights of a ground about its mean plane, as the sum of waves of given lengths in all
/// directions: their power by wavelength.
struct GroundSpectrum {
  struct Band {
    double wavelength_m = 0;
    double sigma_m = 0;  ///< m; standard deviation of the height.
  };
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< dz/dx and dz/dy of the mean plane.
  std::vector<Band> bands;                          ///< Each of twice the length of the one before.
};

/// The structure of a ground: the mean square of the difference of heights (m²) of places that are
/// `lag_m` (m) apart along x or y, about the mean plane.
struct GroundStructure {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  std::vector<double> lag_m, square_m2;
};

/// Measures the structure of a ground at lags that double from a metre (more where a side is longer
/// than 2048 m) to half of its longer side. Places without ground are left out.
GroundStructure structure_of(const primitives::GroundSurface& ground);

/// Returns the spectrum whose waves have that structure, 2 Σ σ² (1 − J₀(2π lag / wavelength)), by
/// least squares of its relative errors over powers that are not negative.
GroundSpectrum spectrum_of(const GroundStructure& structure);

/// Returns a ground with that spectrum over [−x/2, x/2] × [−y/2, y/2] for the sides `size_m`, as a
/// grid of triangles of side `spacing_m` (m) at most: waves with random directions and phases. The
/// same seed gives the same bits. Throws as `test_site::mesh_of_heights` does.
elements::TriangleMesh ground_with(const GroundSpectrum& spectrum, const Eigen::Vector2d& size_m,
                                   double spacing_m, uint64_t seed);

}  // namespace underbrush::sites
