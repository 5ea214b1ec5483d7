/// \file
/// This file has the fitters of ellipsoids behind one interface: the points of a tile go in,
/// ellipsoids come out. `fit` does the rest for all of them: tiles, ground, hit probabilities and
/// free space.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/cluster/beam_spacing.hpp"
#include "underbrush/cluster/bottom_up.hpp"
#include "underbrush/cluster/hierarchical.hpp"
#include "underbrush/cluster/mixture.hpp"
#include "underbrush/cluster/top_down.hpp"
#include "underbrush/cluster/voxel.hpp"

namespace underbrush::cluster {

/// The parameters of the fitters of ellipsoids.
struct VolumetricOptions {
  EllipsoidOptions ellipsoid;
  HierarchicalOptions hierarchical;
  MixtureOptions mixture;  ///< Used by `hierarchical` only.
  VoxelOptions voxel;
  TopDownOptions top_down;
  BottomUpOptions bottom_up;
  /// The spacing of the beams, where ellipsoids fill the space between them (`open_covariances`).
  BeamSpacing spacing;
};

/// Points that are not ground, and the directions from which they were seen.
struct VolumetricPoints {
  std::span<const Vec3f> point;      ///< Finite, m.
  std::span<const Vec3f> to_sensor;  ///< The vector from each point to the sensor, m.
};

/// A clustering and the name of its fitter.
struct Clustering {
  std::string_view name;
  /// Clusters the points of a tile. The seed is for clusterings that draw random numbers.
  Clusters (*clusters)(const VolumetricPoints&, const VolumetricOptions&, uint64_t seed);
  bool mixture = false;    ///< Whether its clusters are the start of a Gaussian mixture.
  bool in_voxels = false;  ///< Whether its clusters are the voxels of a regular grid.
};

/// All clusterings.
std::span<const Clustering> clusterings();
/// Finds a clustering by name, or gives nullptr.
const Clustering* clustering_named(std::string_view name);

/// Clusters points by the clustering `name`. Throws `std::invalid_argument` for an unknown name.
Clusters clusters_of(std::string_view name, const VolumetricPoints& points,
                     const VolumetricOptions& options, uint64_t seed);

/// The ellipsoids of a tile.
struct Volumes {
  std::vector<elements::Ellipsoid> ellipsoids;
  /// The `open_covariances` of the ellipsoids, m², where the options have a spacing, or none.
  std::vector<Eigen::Matrix3f> open;
  size_t unclustered_points = 0;  ///< Points in no cluster.
};

/// Makes the ellipsoids of the points of a tile with the fitter `name`. Throws
/// `std::invalid_argument` for an unknown name.
Volumes volumes(std::string_view name, const VolumetricPoints& points,
                const VolumetricOptions& options, uint64_t seed);

}  // namespace underbrush::cluster
