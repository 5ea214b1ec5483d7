/// \file
/// The structure of a forest stand: plant area density and gap fraction by voxel, canopy height and
/// cover by cell of a map, all of them computed from the hit probabilities of a model.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/metrics/bounds.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush {
/// Maps and voxels of worlds.
namespace rasters {

/// The options of `canopy_of`.
struct CanopyOptions {
  double cell_m = 1;          ///< m; side of the cells of maps and of the voxels.
  int rays = 4;               ///< Number of rays along each side of a cell.
  double cover_height_m = 2;  ///< m; matter higher above the ground is canopy.
};

/// A stand in cells and voxels. Maps have `size[0] · size[1]` values, x fastest; voxel grids have
/// `size[0] · size[1] · size[2]`, x fastest, then y. NaN where there is no value.
struct Canopy {
  Vec3 low = Vec3::Zero();  ///< m, world; lower corner, a multiple of the cell's side.
  double cell_m = 1;
  std::array<uint32_t, 3> size{};
  /// m, world; mean height of the ground, the highest ground triangle below each ray.
  std::vector<float> ground;
  /// m; largest height above the ground at which a vertical ray from above has been stopped with a
  /// probability of at least one half before it comes to the ground; 0 where there is none.
  std::vector<float> height;
  /// Mean probability that a vertical ray from above is stopped higher than `cover_height_m`.
  std::vector<float> cover;
  /// Mean of ∏ (1 − p) over rays through the voxel along x, y and z, as many along each, with the
  /// hit probabilities p of the elements that a ray meets in it, without the ground.
  std::vector<float> gap;
  /// m²/m³; one-sided plant area density, with which the mean of exp(−density · G · side) over the
  /// rays is `gap`. G is that of the leaf angles of the models; where models differ, it is 1/2 as
  /// for leaves of all directions alike. NaN where no ray passes, since the density then is not
  /// known.
  std::vector<float> area_density;
};

/// Columns of cells, in x and y: those from `begin` up to but without `end`.
struct CellBlock {
  std::array<uint32_t, 2> begin{}, end{};

  uint32_t width(size_t axis) const { return end[axis] - begin[axis]; }
};

/// Computes a stand block by block, for which no more of a world is needed than lies in the block.
class CanopyMaker {
 public:
  /// Takes the box of all elements of the world (m). Throws `std::invalid_argument` for options out
  /// of range, `DataError` for an empty box, and for one that needs more than 200 million voxels.
  CanopyMaker(const metrics::Bounds& bounds, const CanopyOptions& options);

  /// The block of all cells.
  CellBlock all() const { return {{0, 0}, {canopy_.size[0], canopy_.size[1]}}; }
  /// The square of a block seen from above (m, world).
  Eigen::AlignedBox2d box_of(const CellBlock& block) const;
  /// The number of voxels above a block.
  uint64_t voxels(const CellBlock& block) const;
  /// Computes the cells of a block and the voxels above them. `world` has at least the elements
  /// that lie in its square or reach into it.
  void add(const trace::World& world, const CellBlock& block);
  /// Returns the stand, once all cells were added. The leaf angles are those of `models`.
  Canopy finish(std::span<const elements::Model> models) &&;

 private:
  CanopyOptions options_;
  Canopy canopy_;
};

/// Computes the cells and voxels of all elements of a scene. `world` was made of `scene`. Throws as
/// `CanopyMaker` does.
Canopy canopy_of(const elements::Scene& scene, const trace::World& world,
                 const CanopyOptions& options = {});

}  // namespace rasters
}  // namespace underbrush
