/// \file
/// A plant as triangles that know which part of it they are, and the shapes it is built from.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::test_site {

/// What a triangle is made of (reflectance differs).
enum class Part : uint8_t { kGround, kWood, kLeaf, kBlade };

/// Opaque triangles (p = 1) at the identity pose: base at the origin, z up.
struct PlantMesh {
  elements::TriangleMesh mesh;
  std::vector<Part> part;  ///< One per triangle.

  uint32_t add_vertex(const Vec3& v) {
    mesh.vertices.push_back(v.cast<float>());
    return uint32_t(mesh.vertices.size() - 1);
  }
  void add_triangle(uint32_t a, uint32_t b, uint32_t c, Part p) {
    mesh.triangles.push_back({a, b, c});
    mesh.hit.emplace_back();
    part.push_back(p);
  }
};

/// One point of a tube's axis.
struct TubePoint {
  Vec3 centre;
  double radius_m;
};

/// A tube of wood along the axis, open at its first point and drawn to a point at its last. At
/// least two points, no two neighbours equal.
void add_tube(PlantMesh& plant, std::span<const TubePoint> axis, int sides);

/// A flat kite of two triangles and area length·width/2 from `base` along the unit vector `axis`;
/// `normal` is a unit vector orthogonal to it.
void add_leaf(PlantMesh& plant, const Vec3& base, const Vec3& axis, const Vec3& normal,
              double length_m, double width_m);

/// One-sided area (m²) of a triangle.
double triangle_area(const elements::TriangleMesh& mesh, size_t triangle);
/// Total one-sided area (m²) of the triangles of one part.
double part_area(const PlantMesh& plant, Part part);
/// Of the vertices; empty for an empty mesh.
Eigen::AlignedBox3d bounds(const elements::TriangleMesh& mesh);

}  // namespace underbrush::test_site
