#include "underbrush/trace/element_math.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/trace/exact.inl"

namespace underbrush::trace {

Intersection approach(const Vec3& origin, const Vec3& direction, const Vec3f& mean,
                      const std::array<float, 6>& covariance) {
  double m[3], s[6];
  std::copy_n(mean.data(), 3, m);
  std::copy_n(covariance.data(), 6, s);
  const Approach<double> a = approach_of(origin.data(), direction.data(), m, s);
  Intersection met;
  met.t_m = a.t;
  met.sigma_m = std::sqrt(a.sigma2);
  met.delta2 = a.delta2;
  return met;
}

namespace {

// Computes x·y − z·w with a sign that is always right. Products are exact where rounding could
// change the sign.
double difference_of_products(double x, double y, double z, double w) {
  const double xy = x * y, zw = z * w, plain = xy - zw;
  if (std::abs(plain) > 1e-15 * (std::abs(xy) + std::abs(zw))) return plain;
  return (std::fma(x, y, -xy) - std::fma(z, w, -zw)) + plain;
}

Vec3 normal_of_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3 at[3] = {a.cast<double>(), b.cast<double>(), c.cast<double>()};
  Vec3 normal;
  normal_of(at[0].data(), at[1].data(), at[2].data(), normal.data());
  return normal;
}

}  // namespace

std::optional<double> crossing(const Vec3& origin, const Vec3& direction, const Vec3f& a,
                               const Vec3f& b, const Vec3f& c) {
  int z;
  direction.cwiseAbs().maxCoeff(&z);
  const int axis[3] = {(z + 1) % 3, (z + 2) % 3, z};
  double o[3], d[3], corner[3][3];
  for (int k = 0; k < 3; ++k) {
    o[k] = origin[axis[k]];
    d[k] = direction[axis[k]];
    corner[0][k] = a[axis[k]];
    corner[1][k] = b[axis[k]];
    corner[2][k] = c[axis[k]];
  }
  const Sheared<double> s = shear(o, d, corner);
  bool above = true, below = true;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double weight = difference_of_products(s.x[i], s.y[j], s.x[j], s.y[i]);
    above &= weight >= 0;
    below &= weight <= 0;
  }
  if (above == below) return std::nullopt;  // outside, or all weights are zero
  const Vec3 normal = normal_of_triangle(a, b, c), first = a.cast<double>();
  return range_to_plane(origin.data(), first.data(), normal.data(),
                        dot(normal.data(), direction.data()));
}

std::array<int64_t, 3> voxel_of(const Vec3& point, double voxel_m) {
  std::array<int64_t, 3> cell{};
  for (int k = 0; k < 3; ++k) cell[size_t(k)] = int64_t(std::floor(point[k] / voxel_m));
  return cell;
}

namespace {

Intersection intersect_ellipsoid(const elements::Model& model, const elements::Ellipsoid& e,
                                 const Vec3& origin, const Vec3& direction) {
  Intersection met = approach(origin, direction, e.mean, e.covariance);
  if (!(met.delta2 <= model.tau * model.tau)) return {};
  if (model.voxel_m > 0 && voxel_of(origin + met.t_m * direction, model.voxel_m) !=
                               voxel_of(e.mean.cast<double>(), model.voxel_m)) {
    return {};
  }
  met.p = e.hit.p;
  if (e.density_per_m > 0) {
    met.p = opacity_of(double(e.density_per_m) * 2 * model.leaf_angles.projection(direction.z()),
                       met.sigma_m, met.delta2);
  }
  return met;
}

double sigma_of(const elements::TriangleMesh& mesh, uint32_t triangle, const Vec3& direction) {
  const double roughness = mesh.roughness_at(triangle);
  if (!(roughness > 0)) return mesh.range_sigma_m;
  const std::array<uint32_t, 3>& corner = mesh.triangles[triangle];
  const Vec3 normal = normal_of_triangle(mesh.vertices[corner[0]], mesh.vertices[corner[1]],
                                         mesh.vertices[corner[2]]);
  return std::sqrt(rough_sigma2(mesh.range_sigma_m, roughness, normal.data(),
                                dot(normal.data(), direction.data())));
}

Intersection intersect_unlimited(const elements::Model& model, uint32_t element, const Vec3& origin,
                                 const Vec3& direction) {
  const elements::ElementPlace at = model.place(element);
  Intersection met;
  if (at.kind == elements::Kind::kEllipsoid) {
    met = intersect_ellipsoid(model, model.ellipsoids[at.index], origin, direction);
    if (met.sigma_m == 0) return {};
  } else {
    const elements::TriangleMesh& mesh = model.mesh(at.kind);
    const auto& corner = mesh.triangles[at.index];
    const auto t = crossing(origin, direction, mesh.vertices[corner[0]], mesh.vertices[corner[1]],
                            mesh.vertices[corner[2]]);
    if (!t) return {};
    met.t_m = *t;
    met.sigma_m = sigma_of(mesh, at.index, direction);
    met.p = mesh.hit[at.index].p;
  }
  met.element = element;
  return met;
}

bool within(const RangeLimits& limits, double t_m) {
  return t_m >= limits.min_m && t_m <= limits.max_m;
}

}  // namespace

Intersection intersect(const elements::Model& model, uint32_t element, const Vec3& origin,
                       const Vec3& direction, const RangeLimits& limits) {
  const Intersection met = intersect_unlimited(model, element, origin, direction);
  return within(limits, met.t_m) ? met : Intersection{};
}

Ray to_model(const elements::Instance& placed, const Ray& ray) {
  const Vec3 offset = ray.origin - placed.world_from_model.translation;
  if (is_translation(placed)) return {offset, ray.direction};
  const Eigen::Quaterniond back = placed.world_from_model.rotation.conjugate();
  return {back * offset / double(placed.scale), back * ray.direction};
}

Grain::Grain(const elements::Model& model, const elements::Instance& placed)
    : model_(&model),
      placed_(placed),
      scale_(double(placed.scale)),
      first_ellipsoid_(uint32_t(model.first_ellipsoid())),
      translation_(is_translation(placed)) {}

bool is_translation(const elements::Instance& placed) {
  return placed.scale == 1 && placed.world_from_model.rotation.w() == 1 &&
         placed.world_from_model.rotation.vec().isZero(0);
}

Intersection intersect(const elements::Model& model, const elements::Instance& placed,
                       uint32_t instance, uint32_t element, const Ray& ray,
                       const RangeLimits& limits) {
  const Ray local = to_model(placed, ray);
  Intersection met = intersect_unlimited(model, element, local.origin, local.direction);
  if (met.none()) return met;
  met.instance = instance;
  met.t_m *= double(placed.scale);
  met.sigma_m *= double(placed.scale);
  return within(limits, met.t_m) ? met : Intersection{};
}

}  // namespace underbrush::trace
