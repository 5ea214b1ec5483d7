#include "underbrush/fit/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/fit/sample_grid.hpp"

namespace underbrush::fit {
namespace {

/// Radius within which points decide the distance at a node: a cell that the surface cuts has its
/// corners within √3 cells of it.
double support_m(const SurfaceOptions& o) { return std::max(o.kernel_m, 2 * o.cell_m); }

/// The cells of a tile: those of `core`, and as many around them as decide its surface.
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
  double cells = 1;
  std::array<double, 3> first{}, size{};
  for (size_t a = 0; a < 3; ++a) {
    first[a] = std::floor(from[a] / o.cell_m) - around;
    size[a] = std::ceil(to[a] / o.cell_m) + around + 1 - first[a];
    cells *= size[a];
    require(std::abs(first[a]) < 1e9, "surface: the tile is too far from the origin");
  }
  require(cells <= double(1 << 27), "surface: the tile exceeds 2^27 cells");
  CellBox box;
  for (size_t a = 0; a < 3; ++a) {
    box.first[a] = int(first[a]);
    box.size[a] = int(size[a]);
  }
  return box;
}

/// Number of the first cell whose lower corner is at or beyond `x`.
int cell_from(double x, double cell_m) { return int(std::ceil(x / cell_m)); }

/// The nodes of the core's cells, over all heights of the samples; none known yet.
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

/// Nodes with a sample's cell within `reach` cells: only there can a sample be within the support.
std::vector<uint8_t> nodes_near(const SampleGrid& grid, const ScalarGrid& field, int reach) {
  std::vector<uint8_t> near(field.value.size(), 0);
  const CellBox& box = grid.box();
  size_t c = 0;
  for (int z = 0; z < box.size[2]; ++z) {
    for (int y = 0; y < box.size[1]; ++y) {
      for (int x = 0; x < box.size[0]; ++x, ++c) {
        if (grid.cell(c).empty()) continue;
        const std::array<int, 3> at{x, y, z};
        std::array<int, 3> low{}, high{};
        for (size_t a = 0; a < 3; ++a) {
          const int here = at[a] + box.first[a] - field.first[a];
          low[a] = std::max(0, here - reach + 1);
          high[a] = std::min(field.size[a] - 1, here + reach);
        }
        if (low[0] > high[0]) continue;
        for (int k = low[2]; k <= high[2]; ++k) {
          for (int j = low[1]; j <= high[1]; ++j) {
            std::fill_n(near.begin() + ptrdiff_t(field.at(low[0], j, k)), high[0] - low[0] + 1, 1);
          }
        }
      }
    }
  }
  return near;
}

void evaluate(const SampleGrid& grid, const SignedDistance& distance, double support,
              ScalarGrid& field) {
  const int reach = int(std::ceil(support / field.cell_m));
  const std::vector<uint8_t> near = nodes_near(grid, field, reach);
  const size_t nx = size_t(field.size[0]), ny = size_t(field.size[1]);
  parallel_for(field.value.size(), 1024, [&](size_t begin, size_t end) {
    std::vector<OrientedPoint> found;
    for (size_t n = begin; n < end; ++n) {
      if (!near[n]) continue;
      const Vec3f x(field.place(0, int(n % nx)), field.place(1, int(n / nx % ny)),
                    field.place(2, int(n / nx / ny)));
      found.clear();
      grid.near(x, float(support), [&](const OrientedPoint& s) {
        found.push_back(s);
        return true;
      });
      if (!found.empty()) field.value[n] = distance(x, found, float(support));
    }
  });
}

/// Removes triangles with a vertex farther than `kernel_m` from every sample, then unused vertices.
void drop_far(const SampleGrid& grid, double kernel_m, IsoMesh& mesh) {
  std::vector<uint32_t> number(mesh.vertices.size(), 0);
  parallel_for(mesh.vertices.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      grid.near(mesh.vertices[v], float(kernel_m), [&](const OrientedPoint&) {
        number[v] = 1;
        return false;
      });
    }
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

/// Distance of a point of the core to the surface: the field, trilinear in its cell; NaN outside.
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

/// Adds up the residuals of the core's points, in pieces of fixed size.
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

}  // namespace

float imls(const Vec3f& x, std::span<const OrientedPoint> near, float support_m) {
  const float scale = 1 / (support_m * support_m);
  float sum = 0, weights = 0;
  for (const OrientedPoint& p : near) {
    const Vec3f d = x - p.position;
    const float u = std::max(0.0f, 1 - scale * d.squaredNorm()), w = u * u * u * u;
    sum += w * p.normal.dot(d);
    weights += w;
  }
  return weights > 0 ? sum / weights : NAN;
}

double surface_margin_m(const SurfaceOptions& o) {
  return support_m(o) + o.kernel_m + 2 * o.cell_m;
}

SurfaceTile surface_tile(std::span<const Vec3f> points, std::span<const Vec3f> to_sensor,
                         const Area& core, const SurfaceOptions& o,
                         const SignedDistance& distance) {
  require(points.size() == to_sensor.size(), "surface: as many directions as points are needed");
  require(o.cell_m > 0 && o.kernel_m > 0 && o.min_neighbours > 0,
          "surface: cell, kernel and number of neighbours must be positive");
  require(std::isfinite(core.x0) && std::isfinite(core.y0) && std::isfinite(core.x1) &&
              std::isfinite(core.y1),
          "surface: the tile's area must be finite");
  SurfaceTile tile;
  if (!(core.x0 < core.x1 && core.y0 < core.y1)) return tile;
  const CellBox box = box_of(points, core, o);
  if (box.count() == 0) return tile;
  SampleGrid grid(points, to_sensor, box, o.cell_m);
  grid.find_normals(o.kernel_m, o.min_neighbours);
  ScalarGrid field = empty_field(box, core, o.cell_m);
  evaluate(grid, distance, support_m(o), field);
  tile.mesh = marching_cubes(field);
  drop_far(grid, o.kernel_m, tile.mesh);
  add_residuals(points, field, o.kernel_m, tile);
  return tile;
}

}  // namespace underbrush::fit
