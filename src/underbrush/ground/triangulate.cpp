#include "underbrush/ground/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/ground/delaunay.hpp"
#include "underbrush/ground/node_mask.hpp"

namespace underbrush::ground {
namespace {

constexpr int kTile = 256;        // cells
constexpr int kSide = kTile + 1;  // nodes
using Triangle = std::array<uint32_t, 3>;

/// Triangles over the nodes of a tile.
struct TileMesh {
  std::vector<std::array<int, 2>> nodes;  ///< (x, y) in the tile.
  std::vector<float> height;
  std::vector<Triangle> triangles;
};

/// The heights of a tile, and the nodes chosen so far. The triangles on covered cells cover them
/// exactly, for this reason: every side of a cell between a covered cell and another has both its
/// nodes chosen, and no other grid node lies in the circle about it, so it is a side of the
/// Delaunay triangulation.
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
    insert_chosen();
    refine(max_error);
    return mesh();
  }

 private:
  static size_t at(int x, int y) { return size_t(y) * kSide + size_t(x); }
  double z(int x, int y) const { return height_[at(x, y)]; }
  bool covered(int x, int y) const {
    return x >= 0 && y >= 0 && x < kTile && y < kTile && exists_[at(x, y)] &&
           exists_[at(x + 1, y)] && exists_[at(x, y + 1)] && exists_[at(x + 1, y + 1)];
  }

  /// Splits as a quadtree does: keeps a square's corners if it is covered and bends less than the
  /// error.
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

  /// Chooses both nodes of each cell side between a covered cell and one that is not covered or
  /// belongs to another tile.
  void choose_edges() {
    for (int y = 0; y <= kTile; ++y) {
      for (int x = 0; x <= kTile; ++x) {
        const bool here = covered(x, y);
        if (here != covered(x - 1, y)) chosen_[at(x, y)] = chosen_[at(x, y + 1)] = 1;
        if (here != covered(x, y - 1)) chosen_[at(x, y)] = chosen_[at(x + 1, y)] = 1;
      }
    }
  }

  /// Inserts the nodes from coarse to fine, row by row to and fro, so that each lies near the one
  /// before.
  void insert_chosen() {
    for (int step = kTile; step >= 1; step /= 2) {
      for (int y = 0; y <= kTile; y += step) {
        for (int n = 0; n <= kTile; n += step) {
          const int x = y / step % 2 ? kTile - n : n;
          const bool before = step < kTile && x % (2 * step) == 0 && y % (2 * step) == 0;
          if (!before && chosen_[at(x, y)]) delaunay_.insert({x, y});
        }
      }
    }
  }

  /// Inserts the worst node of a triangle that is off by more than the error, until there is none.
  void refine(double max_error) {
    std::deque<uint32_t> open;
    for (uint32_t t = 0; t < delaunay_.triangles().size(); ++t) open.push_back(t);
    for (; !open.empty(); open.pop_front()) {
      const GridDelaunay::Triangle& t = delaunay_.triangles()[open.front()];
      if (!covered(t)) continue;
      if (const auto node = worst(t, max_error)) {
        const std::vector<uint32_t>& changed = delaunay_.insert(*node);
        open.insert(open.end(), changed.begin(), changed.end());
      }
    }
  }

  const GridDelaunay::Point& point(uint32_t v) const { return delaunay_.points()[v]; }

  bool covered(const GridDelaunay::Triangle& t) const {
    if (!GridDelaunay::inner(t)) return false;
    int x = 0, y = 0;
    for (uint32_t v : t.point) x += point(v)[0], y += point(v)[1];
    return covered(x / 3, y / 3);
  }

  /// Returns the node of a covered triangle that is off most, if by more than the error.
  std::optional<GridDelaunay::Point> worst(const GridDelaunay::Triangle& t,
                                           double max_error) const {
    const auto &a = point(t.point[0]), &b = point(t.point[1]), &c = point(t.point[2]);
    const int bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
    const int area = bx * cy - by * cx;
    if (area == 1) return std::nullopt;  // Such a triangle holds no other node.
    const double za = z(a[0], a[1]), db = z(b[0], b[1]) - za, dc = z(c[0], c[1]) - za;
    std::optional<GridDelaunay::Point> found;
    const auto [y0, y1] = std::minmax({0, by, cy});
    const auto [x0, x1] = std::minmax({0, bx, cx});
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const int wb = x * cy - y * cx, wc = bx * y - by * x;
        const bool corner = wb == area || wc == area || (wb == 0 && wc == 0);
        if (wb < 0 || wc < 0 || wb + wc > area || corner) continue;
        const double error = std::abs(za + (wb * db + wc * dc) / area - z(a[0] + x, a[1] + y));
        if (error <= max_error) continue;
        max_error = error;
        found = {a[0] + x, a[1] + y};
      }
    }
    return found;
  }

  /// Returns the covered triangles and the nodes that they use.
  TileMesh mesh() const {
    TileMesh m;
    std::vector<int32_t> number(delaunay_.points().size(), -1);
    for (const GridDelaunay::Triangle& t : delaunay_.triangles()) {
      if (!covered(t)) continue;
      Triangle ids{};
      for (size_t k = 0; k < 3; ++k) {
        int32_t& n = number[t.point[k]];
        if (n < 0) {
          n = int32_t(m.nodes.size());
          m.nodes.push_back(point(t.point[k]));
          m.height.push_back(float(z(m.nodes.back()[0], m.nodes.back()[1])));
        }
        ids[k] = uint32_t(n);
      }
      m.triangles.push_back(ids);
    }
    return m;
  }

  std::vector<double> height_;
  std::vector<uint8_t> exists_, chosen_;
  GridDelaunay delaunay_{kTile};
};

/// Joins the tiles' triangles, with one number for each node that they share.
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
  // Corners of the tiles as (j, i), so that they sort row by row.
  std::vector<std::array<int, 2>> corners;
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
