/// \file
/// A plant as triangles with the part of the plant they belong to, and the shapes that plants are
/// built from.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::test_site {

/// The part of a plant, or the ground, that a triangle belongs to. Their reflectances differ.
enum class Part : uint8_t { kGround, kWood, kLeaf, kBlade };

/// Opaque triangles (p = 1) at the identity pose: base at the origin, z up.
struct PlantMesh {
  elements::TriangleMesh mesh;
  std::vector<Part> part;  ///< One for each triangle.

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

/// A point of the axis of a tube.
struct TubePoint {
  Vec3 centre;
  double radius_m;
};

/// Adds a tube of wood along the axis, open at its first point and tapered to a tip at its last.
/// The axis must have at least two points, and neighbours must differ.
void add_tube(PlantMesh& plant, std::span<const TubePoint> axis, int sides);

/// Adds a flat kite of two triangles and area length·width/2 from `base` along the unit vector
/// `axis`. `normal` is a unit vector orthogonal to it.
void add_leaf(PlantMesh& plant, const Vec3& base, const Vec3& axis, const Vec3& normal,
              double length_m, double width_m);

/// Returns the one-sided area (m²) of a triangle.
double triangle_area(const elements::TriangleMesh& mesh, size_t triangle);
/// Returns the total one-sided area (m²) of the triangles of one part.
double part_area(const PlantMesh& plant, Part part);
/// Returns the bounding box of the vertices; empty for an empty mesh.
Eigen::AlignedBox3d bounds(const elements::TriangleMesh& mesh);

}  // namespace underbrush::test_site
