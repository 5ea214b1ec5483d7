#include "underbrush/rasters/canopy.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::rasters {
namespace {

using elements::Kind;

/// Fires rays along an axis, as many in each column of voxels, and multiplies what passes the
/// voxels above a block of cells. All rays begin where those of the whole stand do, so that they
/// meet an element at the same range whatever the block.
class Voxels {
 public:
  Voxels(const Canopy& c, const CellBlock& block, const trace::World& world, int rays)
      : c_(c),
        begin_{block.begin[0], block.begin[1], 0},
        end_{block.end[0], block.end[1], c.size[2]},
        world_(world),
        rays_(rays),
        sum_(size_t(width(0)) * width(1) * width(2), 0) {}

  void fire(size_t axis) {
    const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    parallel_for(width(u), 1, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        for (uint32_t j = 0; j < width(v); ++j) column(axis, uint32_t(i), j);
      }
    });
  }

  /// Writes the means to their places in the stand.
  void write_means(std::vector<float>& gap) const {
    const double n = 3.0 * rays_ * rays_;
    for (size_t k = 0; k < sum_.size(); ++k) {
      const size_t x = begin_[0] + k % width(0), y = begin_[1] + k / width(0) % width(1),
                   z = k / width(0) / width(1);
      gap[x + c_.size[0] * (y + size_t(c_.size[1]) * z)] = float(sum_[k] / n);
    }
  }

 private:
  uint32_t width(size_t axis) const { return end_[axis] - begin_[axis]; }

  void column(size_t axis, uint32_t i, uint32_t j) {
    const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const uint32_t n = c_.size[axis], first = begin_[axis];
    std::vector<double> passing(width(axis));
    std::vector<trace::Intersection> met;
    for (int r = 0; r < rays_ * rays_; ++r) {
      Ray ray{c_.low, Vec3::Unit(Eigen::Index(axis))};
      ray.origin[Eigen::Index(u)] += c_.cell_m * (begin_[u] + i + (r % rays_ + 0.5) / rays_);
      ray.origin[Eigen::Index(v)] +=
          c_.cell_m * (begin_[v] + j + (double(r / rays_) + 0.5) / rays_);
      std::fill(passing.begin(), passing.end(), 1);
      world_.all_intersections(ray, {0, c_.cell_m * n}, c_.cell_m * n, met);
      for (const trace::Intersection& m : met) {
        const uint32_t k = std::min(n - 1, uint32_t(m.t_m / c_.cell_m));
        if (k < first || k >= end_[axis]) continue;
        if (world_.model(m.instance).kind(m.element) == Kind::kGround) continue;
        passing[k - first] *= 1 - m.p;
      }
      for (uint32_t k = 0; k < width(axis); ++k) sum_[at(axis, i, j, k)] += passing[k];
    }
  }

  size_t at(size_t axis, uint32_t i, uint32_t j, uint32_t k) const {
    std::array<size_t, 3> place{};
    place[axis] = k;
    place[(axis + 1) % 3] = i;
    place[(axis + 2) % 3] = j;
    return place[0] + width(0) * (place[1] + size_t(width(1)) * place[2]);
  }

  const Canopy& c_;
  std::array<uint32_t, 3> begin_, end_;
  const trace::World& world_;
  int rays_;
  std::vector<double> sum_;
};

/// What vertical rays from above meet in a cell of the map.
struct Cell {
  double ground_sum = 0, cover_sum = 0, height = 0;
  int rays = 0;

  void add(const std::vector<trace::Intersection>& met, const trace::World& world, double top_m,
           double cover_height_m) {
    const auto is_ground = [&](const trace::Intersection& m) {
      return world.model(m.instance).kind(m.element) == Kind::kGround;
    };
    const auto ground = std::find_if(met.begin(), met.end(), is_ground);
    if (ground == met.end()) return;
    ++rays;
    ground_sum += top_m - ground->t_m;
    double passing = 1, passing_cover = 1;
    for (auto m = met.begin(); m != ground; ++m) {
      const double above = ground->t_m - m->t_m, before = passing;
      passing *= 1 - m->p;
      if (above > cover_height_m) passing_cover *= 1 - m->p;
      if (before > 0.5 && passing <= 0.5) height = std::max(height, above);
    }
    cover_sum += 1 - passing_cover;
  }
};

void map(const trace::World& world, const CellBlock& block, const CanopyOptions& o, Canopy& c) {
  const double top = c.low.z() + c.cell_m * c.size[2] + 1;
  const double depth = top - c.low.z() + 1;
  parallel_for(size_t(block.width(0)) * block.width(1), 16, [&](size_t begin, size_t end) {
    std::vector<trace::Intersection> met;
    for (size_t i = begin; i < end; ++i) {
      const size_t column = block.begin[0] + i % block.width(0),
                   row = block.begin[1] + i / block.width(0), k = column + row * c.size[0];
      Cell cell;
      for (int r = 0; r < o.rays * o.rays; ++r) {
        const double x = double(column) + (r % o.rays + 0.5) / o.rays;
        const double y = double(row) + (double(r / o.rays) + 0.5) / o.rays;
        const Ray ray{Vec3(c.low.x() + c.cell_m * x, c.low.y() + c.cell_m * y, top),
                      -Vec3::UnitZ()};
        world.all_intersections(ray, {0, depth}, depth, met);
        cell.add(met, world, top, o.cover_height_m);
      }
      if (cell.rays == 0) continue;
      c.ground[k] = float(cell.ground_sum / cell.rays);
      c.height[k] = float(cell.height);
      c.cover[k] = float(cell.cover_sum / cell.rays);
    }
  });
}

/// The leaf angles that all models with ellipsoids have in common; spherical ones otherwise.
LeafAngleDistribution leaf_angles_of(std::span<const elements::Model> models) {
  std::optional<LeafAngleDistribution> common;
  for (const elements::Model& m : models) {
    if (m.whole_count(Kind::kEllipsoid) == 0) continue;
    if (common && common->shape() != m.leaf_angles.shape()) return {};
    common = m.leaf_angles;
  }
  return common.value_or(LeafAngleDistribution());
}

/// Solves gap = mean of exp(−density G side) over rays along x, y and z for the density (m²/m³);
/// NaN where the gap is 0.
double density_of(double gap, double side_m, const LeafAngleDistribution& leaves) {
  if (!(gap > 0)) return NAN;
  const double spherical = std::max(0.0, -std::log(gap) / (0.5 * side_m));
  if (leaves.spherical()) return spherical;
  const double level = 2 * leaves.projection(0), upright = 2 * leaves.projection(1);
  double density = spherical / std::max(level, upright);  // too low, or right
  for (int k = 0; k < 50; ++k) {
    const double across = std::exp(-0.5 * density * level * side_m),
                 down = std::exp(-0.5 * density * upright * side_m);
    const double slope = -0.5 * side_m * (2 * level * across + upright * down) / 3;
    const double step = (gap - (2 * across + down) / 3) / slope;
    density += step;
    if (std::abs(step) < 1e-9 * (1 + density)) break;
  }
  return std::max(0.0, density);
}

}  // namespace

CanopyMaker::CanopyMaker(const metrics::Bounds& bounds, const CanopyOptions& options)
    : options_(options) {
  const CanopyOptions& o = options_;
  require(std::isfinite(o.cell_m) && o.cell_m > 0 && o.rays >= 1 && o.rays <= 100 &&
              std::isfinite(o.cover_height_m),
          "canopy: cells and rays must be positive");
  constexpr double kMostVoxels = 2e8;
  if (bounds.empty()) throw DataError("canopy: there are no elements");
  Canopy& c = canopy_;
  c.cell_m = o.cell_m;
  c.low = (bounds.low / o.cell_m).array().floor() * o.cell_m;
  const Vec3 cells = ((bounds.high - c.low) / o.cell_m).array().ceil().max(1);
  require_data(cells.prod() <= kMostVoxels && cells.maxCoeff() < 1e6,
               "canopy: more than 200 million voxels; take larger cells");
  for (size_t d = 0; d < 3; ++d) c.size[d] = uint32_t(cells[Eigen::Index(d)]);
  for (auto* values : {&c.ground, &c.height, &c.cover}) {
    values->assign(size_t(c.size[0]) * c.size[1], NAN);
  }
  c.gap.assign(voxels(all()), NAN);
}

Eigen::AlignedBox2d CanopyMaker::box_of(const CellBlock& block) const {
  const auto at = [&](const std::array<uint32_t, 2>& cell) -> Eigen::Vector2d {
    return canopy_.low.head<2>() + canopy_.cell_m * Eigen::Vector2d(cell[0], cell[1]);
  };
  return {at(block.begin), at(block.end)};
}

uint64_t CanopyMaker::voxels(const CellBlock& block) const {
  return uint64_t(block.width(0)) * block.width(1) * canopy_.size[2];
}

void CanopyMaker::add(const trace::World& world, const CellBlock& block) {
  map(world, block, options_, canopy_);
  Voxels voxels(canopy_, block, world, options_.rays);
  for (const size_t axis : {0, 1, 2}) voxels.fire(axis);
  voxels.write_means(canopy_.gap);
}

Canopy CanopyMaker::finish(std::span<const elements::Model> models) && {
  const LeafAngleDistribution leaves = leaf_angles_of(models);
  canopy_.area_density.reserve(canopy_.gap.size());
  for (const float gap : canopy_.gap) {
    canopy_.area_density.push_back(float(density_of(double(gap), canopy_.cell_m, leaves)));
  }
  return std::move(canopy_);
}

Canopy canopy_of(const elements::Scene& scene, const trace::World& world, const CanopyOptions& o) {
  CanopyMaker maker(metrics::bounds_of(scene.models, scene.instances), o);
  maker.add(world, maker.all());
  return std::move(maker).finish(scene.models);
}

}  // namespace underbrush::rasters
