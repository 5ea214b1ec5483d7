#include "underbrush/ground/delaunay.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::ground {
namespace {

using Point = GridDelaunay::Point;

/// Returns twice the area of the triangle a, b, c: positive if it is counter-clockwise.
int64_t turn(const Point& a, const Point& b, const Point& c) {
  return int64_t(b[0] - a[0]) * (c[1] - a[1]) - int64_t(b[1] - a[1]) * (c[0] - a[0]);
}

/// Returns a positive number if `p` lies inside the circle through a, b, c (counter-clockwise). If
/// these lie on a line, the number is positive on one side of it, which is the limit of a large
/// circle.
int64_t in_circle(const Point& a, const Point& b, const Point& c, const Point& p) {
  const int64_t ax = a[0] - p[0], ay = a[1] - p[1], bx = b[0] - p[0], by = b[1] - p[1];
  const int64_t cx = c[0] - p[0], cy = c[1] - p[1];
  const int64_t aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  return aa * (bx * cy - by * cx) - bb * (ax * cy - ay * cx) + cc * (ax * by - ay * bx);
}

}  // namespace

GridDelaunay::GridDelaunay(int side)
    : side_(side),
      points_{{-1, -1}, {side + 1, -1}, {side + 1, side + 1}, {-1, side + 1}},
      triangles_{{{0, 1, 2}, {-1, 1, -1}}, {{0, 2, 3}, {-1, -1, 0}}} {
  require(side > 0 && side <= 1 << 14, "grid triangulation: the side must be in [1, 2^14]");
}

/// Returns the triangle that holds `p`, inside or on a side, by a walk from the last one found.
uint32_t GridDelaunay::locate(const Point& p) const {
  uint32_t t = last_;
  for (bool moved = true; moved;) {
    moved = false;
    for (size_t k = 0; k < 3 && !moved; ++k) {
      const auto& v = triangles_[t].point;
      if (turn(points_[v[(k + 1) % 3]], points_[v[(k + 2) % 3]], p) >= 0) continue;
      t = uint32_t(triangles_[t].neighbour[k]);
      moved = true;
    }
  }
  return t;
}

/// Replaces the neighbour `from` of `triangle` by `to`.
void GridDelaunay::link(int32_t triangle, uint32_t from, uint32_t to) {
  if (triangle < 0) return;
  for (int32_t& n : triangles_[size_t(triangle)].neighbour) {
    if (n == int32_t(from)) {
      n = int32_t(to);
      return;
    }
  }
}

/// Considers triangle t = (p, a, b) and its neighbour (a, d, b) across a–b. If d lies in the circle
/// of t, the two become (p, a, d) and (p, d, b).
bool GridDelaunay::flip(uint32_t t) {
  const int32_t other = triangles_[t].neighbour[0];
  if (other < 0) return false;
  const uint32_t u = uint32_t(other);
  const Triangle old = triangles_[t], next = triangles_[u];
  size_t k = 0;
  while (next.neighbour[k] != int32_t(t)) ++k;
  const uint32_t p = old.point[0], a = old.point[1], b = old.point[2], d = next.point[k];
  if (in_circle(points_[p], points_[a], points_[b], points_[d]) <= 0) return false;
  // From k on, `next` reads (d, b, a): a–d lies opposite to b, and d–b opposite to a.
  const int32_t beyond_ad = next.neighbour[(k + 1) % 3], beyond_db = next.neighbour[(k + 2) % 3];
  const int32_t beyond_bp = old.neighbour[1], beyond_pa = old.neighbour[2];
  triangles_[t] = {{p, a, d}, {beyond_ad, int32_t(u), beyond_pa}};
  triangles_[u] = {{p, d, b}, {beyond_db, beyond_bp, int32_t(t)}};
  link(beyond_ad, u, t);
  link(beyond_bp, t, u);
  return true;
}

const std::vector<uint32_t>& GridDelaunay::insert(const Point& point) {
  require(point[0] >= 0 && point[0] <= side_ && point[1] >= 0 && point[1] <= side_,
          "grid triangulation: a point lies outside");
  around_.clear();
  const uint32_t t = locate(point);
  last_ = t;
  const Triangle old = triangles_[t];
  for (uint32_t v : old.point) {
    if (points_[v] == point) return around_;
  }
  // One triangle becomes three. If the point lies on a side, one of them has no area until the
  // flips below.
  const uint32_t p = uint32_t(points_.size());
  const uint32_t n = uint32_t(triangles_.size());
  points_.push_back(point);
  const std::array<uint32_t, 3> id{t, n, n + 1};
  triangles_.resize(triangles_.size() + 2);
  for (size_t k = 0; k < 3; ++k) {
    triangles_[id[k]] = {{p, old.point[(k + 1) % 3], old.point[(k + 2) % 3]},
                         {old.neighbour[k], int32_t(id[(k + 1) % 3]), int32_t(id[(k + 2) % 3])}};
    if (k > 0) link(old.neighbour[k], t, id[k]);
  }
  around_.assign(id.begin(), id.end());
  for (size_t k = 0; k < around_.size();) {
    const int32_t other = triangles_[around_[k]].neighbour[0];
    if (flip(around_[k])) {
      around_.push_back(uint32_t(other));
    } else {
      ++k;
    }
  }
  return around_;
}

}  // namespace underbrush::ground
