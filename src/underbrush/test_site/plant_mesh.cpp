#include "underbrush/test_site/plant_mesh.hpp"

#include <cmath>

namespace underbrush::test_site {

void add_tube(PlantMesh& plant, std::span<const TubePoint> axis, int sides) {
  const size_t n = axis.size();
  Vec3 along = (axis[1].centre - axis[0].centre).normalized();
  Vec3 across = along.unitOrthogonal();
  uint32_t ring = 0;  // First vertex of the ring before.
  for (size_t i = 0; i + 1 < n; ++i) {
    // The frame is carried along without twist: each ring lies in the plane between two segments.
    const Vec3 next = (axis[i + 1].centre - axis[i].centre).normalized();
    const Vec3 middle = (along + next).norm() > 0.1 ? (along + next).normalized() : next;
    across = (across - across.dot(middle) * middle).normalized();
    const Vec3 up = middle.cross(across);
    const auto first = uint32_t(plant.mesh.vertices.size());
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * M_PI * k / sides;
      plant.add_vertex(axis[i].centre +
                       axis[i].radius_m * (std::cos(a) * across + std::sin(a) * up));
    }
    for (int k = 0; i > 0 && k < sides; ++k) {
      const auto k0 = uint32_t(k), k1 = uint32_t((k + 1) % sides);
      plant.add_triangle(ring + k0, ring + k1, first + k0, Part::kWood);
      plant.add_triangle(ring + k1, first + k1, first + k0, Part::kWood);
    }
    ring = first;
    along = next;
  }
  const uint32_t tip = plant.add_vertex(axis[n - 1].centre);
  for (int k = 0; k < sides; ++k) {
    plant.add_triangle(ring + uint32_t(k), ring + uint32_t((k + 1) % sides), tip, Part::kWood);
  }
}

void add_leaf(PlantMesh& plant, const Vec3& base, const Vec3& axis, const Vec3& normal,
              double length_m, double width_m) {
  constexpr double kWidestAt = 0.4;
  const Vec3 side = 0.5 * width_m * normal.cross(axis);
  const Vec3 widest = base + kWidestAt * length_m * axis;
  const uint32_t foot = plant.add_vertex(base), right = plant.add_vertex(widest - side);
  const uint32_t tip = plant.add_vertex(base + length_m * axis);
  const uint32_t left = plant.add_vertex(widest + side);
  plant.add_triangle(foot, right, tip, Part::kLeaf);
  plant.add_triangle(foot, tip, left, Part::kLeaf);
}

double triangle_area(const elements::TriangleMesh& mesh, size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3 a = mesh.vertices[t[0]].cast<double>();
  return 0.5 * (mesh.vertices[t[1]].cast<double>() - a)
                   .cross(mesh.vertices[t[2]].cast<double>() - a)
                   .norm();
}

double part_area(const PlantMesh& plant, Part part) {
  double sum = 0;
  for (size_t i = 0; i < plant.part.size(); ++i) {
    if (plant.part[i] == part) sum += triangle_area(plant.mesh, i);
  }
  return sum;
}

Eigen::AlignedBox3d bounds(const elements::TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3f& v : mesh.vertices) box.extend(v.cast<double>());
  return box;
}

}  // namespace underbrush::test_site
