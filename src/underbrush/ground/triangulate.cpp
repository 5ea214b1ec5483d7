#include "underbrush/ground/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/ground/delaunay.hpp"
#include "underbrush/ground/node_mask.hpp"

namespace underbrush::ground {
namespace {

constexpr int kTile = 256;          // cells
constexpr int kSide = kTile + 1;    // nodes
using Triangle = std::array<uint32_t, 3>;

/// Triangles of a tile's nodes.
struct TileMesh {
  std::vector<std::array<int, 2>> nodes;  ///< (x, y) in the tile.
  std::vector<float> height;
  std::vector<Triangle> triangles;
};

/// One tile: its heights, and the nodes chosen so far. Why the triangles that lie on covered cells
/// cover them exactly: every side of a cell between covered and other cells has both its nodes chosen,
/// no other grid node lies in the circle about it, so it is a side of the Delaunay triangulation.
class Tile {
 public:
  Tile(const HeightMap& map, int i0, int j0)
      : height_(window<double>(map.height, i0, j0, kSide, 0)),
        exists_(window<uint8_t>(map.exists, i0, j0, kSide, 0)),
        chosen_(exists_.size(), 0) {}

  /// Chooses nodes and triangulates until no node is off by more than `max_error`.
  TileMesh run(double max_error, int coarsest) {
    for (int y = 0; y < kTile; y += coarsest) {
      for (int x = 0; x < kTile; x += coarsest) split(x, y, coarsest, max_error);
    }
    choose_edges();
    do triangulate_chosen();
    while (choose_worst(max_error));
    for (const auto& n : mesh_.nodes) mesh_.height.push_back(float(z(n[0], n[1])));
    return std::move(mesh_);
  }

 private:
  static size_t at(int x, int y) { return size_t(y) * kSide + size_t(x); }
  double z(int x, int y) const { return height_[at(x, y)]; }
  bool covered(int x, int y) const {
    return x >= 0 && y >= 0 && x < kTile && y < kTile && exists_[at(x, y)] && exists_[at(x + 1, y)] &&
           exists_[at(x, y + 1)] && exists_[at(x + 1, y + 1)];
  }

  /// Quadtree: keeps a square's corners if the square is covered and bends less than the error.
  void split(int x, int y, int side, double max_error) {
    if (side == 1 ? covered(x, y) : flat(x, y, side, max_error)) {
      for (int k = 0; k < 4; ++k) chosen_[at(x + (k & 1) * side, y + (k >> 1) * side)] = 1;
    } else if (side > 1) {
      const int half = side / 2;
      for (int k = 0; k < 4; ++k) split(x + (k & 1) * half, y + (k >> 1) * half, half, max_error);
    }
  }
  bool flat(int x, int y, int side, double max_error) const {
    const double z00 = z(x, y), z10 = z(x + side, y), z01 = z(x, y + side);
    const double z11 = z(x + side, y + side);
    for (int v = 0; v <= side; ++v) {
      for (int u = 0; u <= side; ++u) {
        if (!exists_[at(x + u, y + v)]) return false;
        const double a = double(u) / side, b = double(v) / side;
        const double line = (1 - b) * ((1 - a) * z00 + a * z10) + b * ((1 - a) * z01 + a * z11);
        if (std::abs(line - z(x + u, y + v)) > max_error) return false;
      }
    }
    return true;
  }

  /// Both nodes of each cell side between a covered cell and one that is not, or of another tile.
  void choose_edges() {
    for (int y = 0; y <= kTile; ++y) {
      for (int x = 0; x <= kTile; ++x) {
        const bool here = covered(x, y);
        if (here != covered(x - 1, y)) chosen_[at(x, y)] = chosen_[at(x, y + 1)] = 1;
        if (here != covered(x, y - 1)) chosen_[at(x, y)] = chosen_[at(x + 1, y)] = 1;
      }
    }
  }

  void triangulate_chosen() {
    mesh_ = {};
    std::vector<Eigen::Vector2d> points;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (!chosen_[at(x, y)]) continue;
        mesh_.nodes.push_back({x, y});
        points.emplace_back(x, y);
      }
    }
    for (const Triangle& t : delaunay(points)) {
      const Eigen::Vector2d middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3;
      if (covered(int(middle.x()), int(middle.y()))) mesh_.triangles.push_back(t);
    }
  }

  /// Chooses each triangle's worst node if that is off by more than the error; whether any was.
  bool choose_worst(double max_error) {
    bool any = false;
    for (const Triangle& t : mesh_.triangles) {
      const auto &a = mesh_.nodes[t[0]], &b = mesh_.nodes[t[1]], &c = mesh_.nodes[t[2]];
      const int bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
      const int area = bx * cy - by * cx;
      if (area == 1) continue;  // holds no other node
      const double za = z(a[0], a[1]), db = z(b[0], b[1]) - za, dc = z(c[0], c[1]) - za;
      double worst = max_error;
      size_t worst_at = 0;
      const auto [y0, y1] = std::minmax({0, by, cy});
      const auto [x0, x1] = std::minmax({0, bx, cx});
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const int wb = x * cy - y * cx, wc = bx * y - by * x;
          if (wb < 0 || wc < 0 || wb + wc > area) continue;
          const double error = std::abs(za + (wb * db + wc * dc) / area - z(a[0] + x, a[1] + y));
          if (error <= worst || chosen_[at(a[0] + x, a[1] + y)]) continue;
          worst = error;
          worst_at = at(a[0] + x, a[1] + y);
        }
      }
      if (worst <= max_error) continue;
      chosen_[worst_at] = 1;
      any = true;
    }
    return any;
  }

  std::vector<double> height_;
  std::vector<uint8_t> exists_, chosen_;
  TileMesh mesh_;
};

/// The tiles' triangles with one number for each node they share.
GroundMesh joined(const HeightMap& map, const std::vector<std::array<int, 2>>& corners,
                  const std::vector<TileMesh>& tiles) {
  GroundMesh mesh{map.origin, {}, {}};
  BlockMap<int32_t> number;
  for (const auto& [key, block] : map.exists) number[key].fill(-1);
  for (size_t k = 0; k < tiles.size(); ++k) {
    const auto number_of = [&](uint32_t v) {
      const auto [x, y] = tiles[k].nodes[v];
      const int i = corners[k][0] + x, j = corners[k][1] + y;
      int32_t& n = number.at(block_of(i, j))[size_t(place_in_block(i, j))];
      if (n < 0) {
        n = int32_t(mesh.vertices.size());
        mesh.vertices.emplace_back(float(i * map.spacing_m), float(j * map.spacing_m),
                                   tiles[k].height[v]);
      }
      return uint32_t(n);
    };
    for (const Triangle& t : tiles[k].triangles) {
      const uint32_t a = number_of(t[0]), b = number_of(t[1]), c = number_of(t[2]);
      mesh.triangles.push_back({a, b, c});
    }
  }
  return mesh;
}

}  // namespace

GroundMesh triangulate(const HeightMap& map, const TriangulateOptions& options) {
  require(options.max_error_m >= 0, "triangulate: the error must not be negative");
  const double longest = options.max_side_m / map.spacing_m / std::sqrt(2.0);
  require(longest >= 1, "triangulate: max_side_m is shorter than a cell's diagonal");
  int coarsest = 1;
  while (2 * coarsest <= std::min(longest, double(kTile))) coarsest *= 2;
  constexpr int kBlocks = kTile / kBlockSide;
  std::vector<std::array<int, 2>> corners;  // of the tiles, (j, i) so that they sort row by row
  for (const auto& [key, block] : map.exists) {
    corners.push_back({key.y & ~(kBlocks - 1), key.x & ~(kBlocks - 1)});
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (auto& c : corners) c = {c[1] * kBlockSide, c[0] * kBlockSide};
  std::vector<TileMesh> tiles(corners.size());
  parallel_for(tiles.size(), 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      tiles[k] = Tile(map, corners[k][0], corners[k][1]).run(options.max_error_m, coarsest);
    }
  });
  return joined(map, corners, tiles);
}

}  // namespace underbrush::ground
