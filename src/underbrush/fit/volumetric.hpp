/// \file
/// The fitters of volumetric elements behind one interface: points of a tile in, ellipsoids out.
/// Ground, tiles, hit probabilities and free space are `fit()`'s, the same for all.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "underbrush/fit/bottom_up.hpp"
#include "underbrush/fit/hierarchical.hpp"
#include "underbrush/fit/mixture.hpp"
#include "underbrush/fit/top_down.hpp"
#include "underbrush/fit/voxel.hpp"

namespace underbrush::fit {

/// Parameters of the volumetric fitters.
struct VolumetricOptions {
  EllipsoidOptions ellipsoid;
  HierarchicalOptions hierarchical;
  MixtureOptions mixture;  ///< Of `hierarchical` alone.
  VoxelOptions voxel;
  TopDownOptions top_down;
  BottomUpOptions bottom_up;
};

/// Points that are not ground, and from where they were seen.
struct VolumetricPoints {
  std::span<const Vec3f> point;      ///< m, finite.
  std::span<const Vec3f> to_sensor;  ///< From each point to the sensor, m.
};

/// A clustering under the name of its fitter.
struct Clustering {
  std::string_view name;
  /// Clusters of the points of a tile; the seed is for those that draw random numbers.
  Clusters (*clusters)(const VolumetricPoints&, const VolumetricOptions&, uint64_t seed);
  bool mixture = false;    ///< Its clusters begin a Gaussian mixture.
  bool in_voxels = false;  ///< Its clusters are the voxels of a regular grid.
};

/// All clusterings.
std::span<const Clustering> clusterings();
/// The clustering of this name, or nullptr.
const Clustering* clustering_named(std::string_view name);

/// The clusters that the fitter `name` makes. Throws `std::invalid_argument` for an unknown name.
Clusters clusters_of(std::string_view name, const VolumetricPoints& points,
                     const VolumetricOptions& options, uint64_t seed);

/// The ellipsoids of one tile.
struct Volumes {
  std::vector<elements::Ellipsoid> ellipsoids;
  size_t unclustered_points = 0;  ///< Points in no cluster.
};

/// The ellipsoids that the fitter `name` makes of the points of one tile.
Volumes volumes(std::string_view name, const VolumetricPoints& points,
                const VolumetricOptions& options, uint64_t seed);

}  // namespace underbrush::fit
