#include "underbrush/elements/element_light.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::elements {
namespace {

double cosine_on(const TriangleMesh& mesh, uint32_t triangle, const Vec3& direction) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Vec3 from = mesh.vertices[a].cast<double>();
  const Vec3 normal =
      (mesh.vertices[b].cast<double>() - from).cross(mesh.vertices[c].cast<double>() - from);
  const double length = normal.norm();
  return length > 0 ? std::min(1.0, std::abs(normal.dot(direction)) / length) : 1;
}

// By the adjugate A = det(Σ) Σ⁻¹, whose determinant cancels.
double cosine_on(const Ellipsoid& e, const Vec3& d) {
  const double xx = e.covariance[0], xy = e.covariance[1], xz = e.covariance[2];
  const double yy = e.covariance[3], yz = e.covariance[4], zz = e.covariance[5];
  const double a = yy * zz - yz * yz, b = xx * zz - xz * xz, c = xx * yy - xy * xy;
  const double across = d.x() * d.y() * (xz * yz - xy * zz) + d.x() * d.z() * (xy * yz - xz * yy) +
                        d.y() * d.z() * (xy * xz - xx * yz);
  const double along = d.x() * d.x() * a + d.y() * d.y() * b + d.z() * d.z() * c + 2 * across;
  return std::sqrt(std::clamp(along / (a + b + c), 0.0, 1.0));
}

}  // namespace

double incidence_cosine(const Model& model, size_t element, const Vec3& direction) {
  const ElementPlace at = model.place(element);
  if (at.kind == Kind::kEllipsoid) return cosine_on(model.ellipsoids[at.index], direction);
  return cosine_on(model.mesh(at.kind), at.index, direction);
}

Reflectance reflectance(const Model& model, size_t element) {
  const ElementPlace at = model.place(element);
  if (at.kind == Kind::kEllipsoid) return model.ellipsoids[at.index].light;
  const TriangleMesh& mesh = model.mesh(at.kind);
  return mesh.light.empty() ? Reflectance{} : mesh.light[at.index];
}

MeanReflectance mean_reflectance(const Model& model, Kind kind) {
  if (model.part_of) return model.part_of->reflectance[size_t(kind)];
  double hits = 0, sum = 0, squares = 0;
  for (size_t e = 0; e < model.size(); ++e) {
    if (model.kind(e) != kind) continue;
    const double weight = 1.0 + model.hit(e).hits;
    const Reflectance of = reflectance(model, e);
    const auto mean = double(of.mean), spread = double(of.spread);
    hits += weight;
    sum += weight * mean;
    squares += weight * (mean * mean + spread * spread);
  }
  if (hits == 0) return {};
  const double mean = sum / hits;
  return {mean, std::sqrt(std::max(0.0, squares / hits - mean * mean))};
}

}  // namespace underbrush::elements
