#include "underbrush/surface/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/surface/sample_grid.hpp"

namespace underbrush::surface {
namespace {

constexpr double kCellsAtOnce = 1 << 25;  // They take about 0.4 GiB.
constexpr double kMostCells = 1 << 27;

/// Computes the least radius. A cell that the surface cuts has its corners within √3 cells of the
/// surface, so two cells suffice.
double least_radius_m(const SurfaceOptions& o) { return 2 * o.cell_m; }

/// Lists the radii in rising order. Each sample takes the first one with enough neighbours.
std::vector<double> radii_m(const SurfaceOptions& o) {
  const double least = std::max(o.least_kernel_m, least_radius_m(o));
  std::vector<double> radii{std::max(o.kernel_m, least_radius_m(o))};
  while (radii.back() / 2 >= least) radii.push_back(radii.back() / 2);
  std::reverse(radii.begin(), radii.end());
  return radii;
}

/// Computes the box of cells that decides a tile's surface: those of `core` and a margin around
/// them.
CellBox box_of(std::span<const Vec3f> points, const Area& core, const SurfaceOptions& o) {
  const double margin = surface_margin_m(o);
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const Vec3f& p : points) {
    if (!p.allFinite() || double(p.x()) < core.x0 - margin || double(p.x()) > core.x1 + margin ||
        double(p.y()) < core.y0 - margin || double(p.y()) > core.y1 + margin) {
      continue;
    }
    low = std::min(low, p.z());
    high = std::max(high, p.z());
  }
  if (!(low <= high)) return {};
  const std::array<double, 3> from{core.x0, core.y0, double(low)},
      to{core.x1, core.y1, double(high)};
  const double around = std::ceil(margin / o.cell_m);
  CellBox box;
  for (size_t a = 0; a < 3; ++a) {
    const double first = std::floor(from[a] / o.cell_m) - around;
    const double size = std::ceil(to[a] / o.cell_m) + around + 1 - first;
    require(std::abs(first) < 1e9 && size < 1e9, "surface: the tile is too far from the origin");
    box.first[a] = int(first);
    box.size[a] = int(size);
  }
  return box;
}

/// Gives the number of the first cell whose lower corner is at or beyond `x`.
int cell_from(double x, double cell_m) { return int(std::ceil(x / cell_m)); }

/// Makes a field of the nodes of the core's cells, over all heights of the samples. No value is
/// known yet.
ScalarGrid empty_field(const CellBox& box, const Area& core, double cell_m) {
  ScalarGrid field;
  field.cell_m = cell_m;
  field.first = {cell_from(core.x0, cell_m), cell_from(core.y0, cell_m), box.first[2]};
  field.size = {cell_from(core.x1, cell_m) + 1 - field.first[0],
                cell_from(core.y1, cell_m) + 1 - field.first[1], box.size[2]};
  if (field.size[0] < 2 || field.size[1] < 2) field.size = {0, 0, 0};
  field.value.assign(size_t(field.size[0]) * size_t(field.size[1]) * size_t(field.size[2]), NAN);
  return field;
}

/// Marks the nodes that a sample may reach.
std::vector<uint8_t> nodes_near(const SampleGrid& grid, const ScalarGrid& field) {
  std::vector<uint8_t> near(field.value.size(), 0);
  for (const SampleGrid::Level& level : grid.levels()) {
    for (const OrientedPoint& s : level.samples) {
      std::array<int, 3> low{}, high{};
      for (size_t a = 0; a < 3; ++a) {
        const double at = double(s.position[int(a)]), r = double(level.radius_m);
        low[a] = std::max(0, cell_from(at - r, field.cell_m) - field.first[a]);
        high[a] = std::min(field.size[a], cell_from(at + r, field.cell_m) - field.first[a]);
      }
      for (int k = low[2]; k < high[2]; ++k) {
        for (int j = low[1]; j < high[1] && low[0] < high[0]; ++j) {
          std::fill_n(near.begin() + ptrdiff_t(field.at(low[0], j, k)), high[0] - low[0], 1);
        }
      }
    }
  }
  return near;
}

void evaluate(const SampleGrid& grid, const SignedDistance& distance, ScalarGrid& field) {
  const std::vector<uint8_t> near = nodes_near(grid, field);
  const size_t nx = size_t(field.size[0]), ny = size_t(field.size[1]);
  parallel_for(field.value.size(), 1024, [&](size_t begin, size_t end) {
    std::vector<OrientedPoint> found;
    for (size_t n = begin; n < end; ++n) {
      if (!near[n]) continue;
      const Vec3f x(field.place(0, int(n % nx)), field.place(1, int(n / nx % ny)),
                    field.place(2, int(n / nx / ny)));
      found.clear();
      grid.reaching(x, [&](const OrientedPoint& s) { found.push_back(s); });
      if (!found.empty()) field.value[n] = distance(x, found);
    }
  });
}

/// Whether the samples surround `x` [adamson04]: |Σ w (p − x) / r| ≤ border Σ w.
bool inside(const SampleGrid& grid, double border, const Vec3f& x) {
  Vec3f offset = Vec3f::Zero();
  float weights = 0;
  grid.reaching(x, [&](const OrientedPoint& p) {
    const float w = weight(x, p);
    offset += w / p.radius_m * (p.position - x);
    weights += w;
  });
  return weights > 0 && offset.norm() <= float(border) * weights;
}

/// Removes triangles with a vertex beyond the border of the samples, then unused vertices.
void trim(const SampleGrid& grid, double border, IsoMesh& mesh) {
  std::vector<uint32_t> number(mesh.vertices.size(), 0);
  parallel_for(mesh.vertices.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) number[v] = inside(grid, border, mesh.vertices[v]);
  });
  std::erase_if(mesh.triangles, [&](const std::array<uint32_t, 3>& t) {
    return !(number[t[0]] && number[t[1]] && number[t[2]]);
  });
  std::fill(number.begin(), number.end(), 0);
  for (const auto& t : mesh.triangles) {
    for (uint32_t v : t) number[v] = 1;
  }
  uint32_t kept = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!number[v]) continue;
    mesh.vertices[kept] = mesh.vertices[v];
    number[v] = kept++;
  }
  mesh.vertices.resize(kept);
  for (auto& t : mesh.triangles) {
    for (uint32_t& v : t) v = number[v];
  }
}

/// Computes the signed distance of a point of the core to the surface by trilinear interpolation of
/// the field; NaN outside.
float field_at(const ScalarGrid& field, const Vec3f& p) {
  std::array<int, 3> cell{};
  Vec3f s;
  for (size_t a = 0; a < 3; ++a) {
    const double at = double(p[int(a)]) / field.cell_m - field.first[a];
    if (!(at >= 0 && at < field.size[a] - 1)) return NAN;
    cell[a] = int(at);
    s[int(a)] = float(at - cell[a]);
  }
  float sum = 0;
  for (int c = 0; c < 8; ++c) {
    float w = 1;
    for (int a = 0; a < 3; ++a) w *= c >> a & 1 ? s[a] : 1 - s[a];
    sum += w * field.value[field.at(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2))];
  }
  return sum;
}

/// Adds up the residuals of the core's points, in pieces of a fixed size, so that the order of sums
/// is fixed.
void add_residuals(std::span<const Vec3f> points, const ScalarGrid& field, double farthest,
                   SurfaceTile& tile) {
  constexpr size_t kGrain = 1 << 14;
  struct Piece {
    double squares = 0;
    size_t n = 0;
  };
  std::vector<Piece> pieces((points.size() + kGrain - 1) / kGrain);
  parallel_for(points.size(), kGrain, [&](size_t begin, size_t end) {
    Piece& piece = pieces[begin / kGrain];
    for (size_t i = begin; i < end; ++i) {
      const double r = double(field_at(field, points[i]));
      if (!(std::abs(r) <= farthest)) continue;
      piece.squares += r * r;
      ++piece.n;
    }
  });
  for (const Piece& piece : pieces) {
    tile.sum_squares_m2 += piece.squares;
    tile.points += piece.n;
  }
}

/// Appends the surface of a neighbouring piece.
void append(SurfaceTile other, SurfaceTile& tile) {
  const uint32_t first = uint32_t(tile.mesh.vertices.size());
  tile.mesh.vertices.insert(tile.mesh.vertices.end(), other.mesh.vertices.begin(),
                            other.mesh.vertices.end());
  for (const auto& t : other.mesh.triangles) {
    tile.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  tile.sum_squares_m2 += other.sum_squares_m2;
  tile.points += other.points;
}

/// Computes the surface over `core` in pieces that are small enough for memory.
SurfaceTile surface_over(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& o,
                         const SignedDistance& distance) {
  SurfaceTile tile;
  const CellBox box = box_of(points, core, o);
  if (box.empty()) return tile;
  const double dx = core.x1 - core.x0, dy = core.y1 - core.y0;
  const double least = std::max(64 * o.cell_m, surface_margin_m(o));
  if (box.count() > kCellsAtOnce && std::max(dx, dy) > 2 * least) {
    Area low = core, high = core;
    if (dx > dy) {
      low.x1 = high.x0 = core.x0 + dx / 2;
    } else {
      low.y1 = high.y0 = core.y0 + dy / 2;
    }
    tile = surface_over(points, to_sensor, low, o, distance);
    append(surface_over(points, to_sensor, high, o, distance), tile);
    return tile;
  }
  require_data(box.count() <= kMostCells,
               "surface: the points are too high for its cells: make them larger");
  SampleGrid grid(points, to_sensor, box, o.cell_m);
  grid.find_normals(radii_m(o), o.min_neighbours);
  ScalarGrid field = empty_field(box, core, o.cell_m);
  evaluate(grid, distance, field);
  tile.mesh = marching_cubes(field);
  trim(grid, o.border, tile.mesh);
  add_residuals(points, field, o.kernel_m, tile);
  return tile;
}

}  // namespace

double surface_margin_m(const SurfaceOptions& o) {
  return 2 * std::max(o.kernel_m, least_radius_m(o)) + 2 * o.cell_m;
}

SurfaceTile surface_tile(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& o,
                         const SignedDistance& distance) {
  require(points.size() == to_sensor.size(), "surface: as many directions as points are needed");
  require(o.cell_m > 0 && o.kernel_m > 0 && o.least_kernel_m > 0 && o.min_neighbours > 0 &&
              o.border > 0,
          "surface: cell, kernel, number of neighbours and border must be positive");
  require(std::isfinite(core.x0) && std::isfinite(core.y0) && std::isfinite(core.x1) &&
              std::isfinite(core.y1),
          "surface: the tile's area must be finite");
  if (!(core.x0 < core.x1 && core.y0 < core.y1)) return {};
  return surface_over(points, to_sensor, core, o, distance);
}

}  // namespace underbrush::surface
