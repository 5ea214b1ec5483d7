#include "underbrush/surface/marching_cubes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::surface {
namespace {

/// Lists the corners of each face in order, counter-clockwise seen from outside.
std::array<std::array<int, 4>, 6> cube_faces() {
  std::array<std::array<int, 4>, 6> faces{};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3), up = 1 << axis;
    faces[size_t(2 * axis)] = {0, v, u + v, u};
    faces[size_t(2 * axis + 1)] = {up, up + u, up + u + v, up + v};
  }
  return faces;
}

int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const auto [low, high] = cube_edge(e);
    if ((low == a && high == b) || (low == b && high == a)) return e;
  }
  return -1;
}

/// Whether two edges bound one face.
bool on_one_face(int e, int f) {
  for (const auto& face : cube_faces()) {
    int found = 0;
    for (size_t k = 0; k < 4; ++k) {
      const int g = edge_between(face[k], face[(k + 1) % 4]);
      found += (g == e) + (g == f);
    }
    if (found == 2) return true;
  }
  return false;
}

/// Cuts a loop of edges into triangles. No cut runs along a face of the cell, where the next cell
/// might cut too. Gives whether such cuts exist.
bool cut_loop(std::vector<int> loop, CubeTriangles& triangles) {
  if (loop.size() < 3) return true;
  const size_t n = loop.size(), had = triangles.size();
  for (size_t k = 0; k < n; ++k) {
    const int a = loop[k], b = loop[(k + 1) % n], c = loop[(k + 2) % n];
    if (n > 3 && on_one_face(a, c)) continue;
    triangles.push_back({uint8_t(a), uint8_t(b), uint8_t(c)});
    std::vector<int> rest = loop;
    rest.erase(rest.begin() + ptrdiff_t((k + 1) % n));
    if (n == 3 || cut_loop(rest, triangles)) return true;
    triangles.resize(had);
  }
  return false;
}

CubeTriangles triangles_of(int pattern) {
  const auto negative = [pattern](int corner) { return (pattern >> corner & 1) != 0; };
  // Each face is walked counter-clockwise from outside. A segment leaves through the edge where the
  // walk enters the negative part, and returns through the next edge where the walk leaves it.
  std::array<int, 12> next;
  next.fill(-1);
  for (const auto& face : cube_faces()) {
    for (size_t k = 0; k < 4; ++k) {
      if (negative(face[k]) || !negative(face[(k + 1) % 4])) continue;
      size_t m = k + 1;
      while (negative(face[(m + 1) % 4])) ++m;
      next[size_t(edge_between(face[k], face[(k + 1) % 4]))] =
          edge_between(face[m % 4], face[(m + 1) % 4]);
    }
  }
  CubeTriangles triangles;
  for (int e = 0; e < 12; ++e) {
    std::vector<int> loop;
    for (int at = e; next[size_t(at)] >= 0;) {
      loop.push_back(at);
      at = std::exchange(next[size_t(at)], -1);
    }
    if (!cut_loop(loop, triangles)) throw std::logic_error("marching cubes: a loop resists");
  }
  return triangles;
}

}  // namespace

std::array<int, 2> cube_edge(int edge) {
  const int axis = edge / 4, m = edge % 4;
  const int low = (m & 1) << ((axis + 1) % 3) | (m >> 1) << ((axis + 2) % 3);
  return {low, low | 1 << axis};
}

const std::array<CubeTriangles, 256>& cube_triangles() {
  static const std::array<CubeTriangles, 256> table = [] {
    std::array<CubeTriangles, 256> all;
    for (int pattern = 0; pattern < 256; ++pattern) all[size_t(pattern)] = triangles_of(pattern);
    return all;
  }();
  return table;
}

namespace {

/// Finds where an edge of the grid is crossed, as the fraction from its lower node; NaN where it is
/// not.
float crossing(float a, float b) {
  return (a < 0) != (b < 0) && !std::isnan(a) && !std::isnan(b) ? a / (a - b) : NAN;
}

/// Computes the sign pattern of the cell with the lowest node (i, j, k); 0 if a corner is NaN.
int pattern_of(const ScalarGrid& g, int i, int j, int k) {
  int pattern = 0;
  for (int c = 0; c < 8; ++c) {
    const float v = g.value[g.at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
    if (std::isnan(v)) return 0;
    pattern |= int(v < 0) << c;
  }
  return pattern;
}

/// A row of nodes, which are all x of one y and z. It has its vertices, and its cells' triangles by
/// the numbers (node · 3 + axis) of edges.
struct Row {
  std::vector<size_t> edges;
  std::vector<Vec3f> vertices;
  std::vector<std::array<size_t, 3>> triangles;
};

Row march_row(const ScalarGrid& g, int j, int k) {
  Row row;
  for (int i = 0; i < g.size[0]; ++i) {
    const float a = g.value[g.at(i, j, k)];
    if (std::isnan(a)) continue;
    const std::array<int, 3> node{i, j, k};
    for (int axis = 0; axis < 3; ++axis) {
      if (node[size_t(axis)] + 1 >= g.size[size_t(axis)]) continue;
      const float b = g.value[g.at(i + (axis == 0), j + (axis == 1), k + (axis == 2))];
      const float s = crossing(a, b);
      if (std::isnan(s)) continue;
      Vec3f p(g.place(0, i), g.place(1, j), g.place(2, k));
      const float next = g.place(axis, node[size_t(axis)] + 1);
      p[axis] += s * (next - p[axis]);
      row.edges.push_back(3 * g.at(i, j, k) + size_t(axis));
      row.vertices.push_back(p);
    }
    if (i + 1 >= g.size[0] || j + 1 >= g.size[1] || k + 1 >= g.size[2]) continue;
    for (const auto& t : cube_triangles()[size_t(pattern_of(g, i, j, k))]) {
      std::array<size_t, 3> ids{};
      for (size_t m = 0; m < 3; ++m) {
        const int low = cube_edge(t[m])[0];
        ids[m] = 3 * g.at(i + (low & 1), j + (low >> 1 & 1), k + (low >> 2)) + t[m] / 4;
      }
      row.triangles.push_back(ids);
    }
  }
  return row;
}

}  // namespace

IsoMesh marching_cubes(const ScalarGrid& grid) {
  for (int axis = 0; axis < 3; ++axis)
    require(grid.size[size_t(axis)] >= 0, "marching cubes: size");
  const size_t rows = size_t(grid.size[1]) * size_t(grid.size[2]);
  require(grid.cell_m > 0 && grid.value.size() == rows * size_t(grid.size[0]),
          "marching cubes: the cell must be positive and the values as many as the nodes");
  std::vector<Row> row(rows);
  parallel_for(rows, 16, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      row[r] = march_row(grid, int(r % size_t(grid.size[1])), int(r / size_t(grid.size[1])));
    }
  });
  // Vertices are numbered row by row. Unused ones, beside cells that were left out, are removed.
  const auto place = [&](size_t id) {
    const Row& r = row[id / 3 / size_t(grid.size[0])];
    return size_t(std::lower_bound(r.edges.begin(), r.edges.end(), id) - r.edges.begin());
  };
  std::vector<size_t> first(rows + 1, 0);
  for (size_t r = 0; r < rows; ++r) first[r + 1] = first[r] + row[r].vertices.size();
  std::vector<uint32_t> number(first.back(), 0);
  IsoMesh mesh;
  for (const Row& r : row) {
    for (const auto& t : r.triangles) {
      std::array<uint32_t, 3> ids{};
      for (size_t m = 0; m < 3; ++m) {
        ids[m] = uint32_t(first[t[m] / 3 / size_t(grid.size[0])] + place(t[m]));
        number[ids[m]] = 1;
      }
      mesh.triangles.push_back(ids);
    }
  }
  uint32_t used = 0;
  for (size_t r = 0; r < rows; ++r) {
    for (size_t v = 0; v < row[r].vertices.size(); ++v) {
      if (!number[first[r] + v]) continue;
      number[first[r] + v] = used++;
      mesh.vertices.push_back(row[r].vertices[v]);
    }
  }
  for (auto& t : mesh.triangles) {
    for (uint32_t& v : t) v = number[v];
  }
  return mesh;
}

}  // namespace underbrush::surface
