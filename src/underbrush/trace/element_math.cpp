#include "underbrush/trace/element_math.hpp"

#include <cmath>

namespace underbrush::trace {

Met approach(const Vec3& origin, const Vec3& direction, const Vec3f& mean,
             const std::array<float, 6>& s) {
  // Σ⁻¹ up to the factor 1/det, by cofactors.
  const double a = s[0], b = s[1], c = s[2], d = s[3], e = s[4], f = s[5];
  const double i00 = d * f - e * e, i01 = c * e - b * f, i02 = b * e - c * d;
  const double i11 = a * f - c * c, i12 = b * c - a * e, i22 = a * d - b * b;
  const double det = a * i00 + b * i01 + c * i02;
  const auto apply = [&](const Vec3& x) {
    return Vec3(i00 * x[0] + i01 * x[1] + i02 * x[2], i01 * x[0] + i11 * x[1] + i12 * x[2],
                i02 * x[0] + i12 * x[1] + i22 * x[2]);
  };
  // From the foot point of the mean on the ray, so that far means lose no digits.
  const Vec3 to_mean = mean.cast<double>() - origin;
  const double t0 = to_mean.dot(direction);
  const Vec3 q = to_mean - t0 * direction;
  const Vec3 d_w = apply(direction);
  const double dd = d_w.dot(direction), dq = d_w.dot(q);
  const double step = dq / dd;
  const Vec3 r = q - step * direction;
  Met met;
  met.t_m = t0 + step;
  met.sigma_m = std::sqrt(det / dd);
  met.delta2 = apply(r).dot(r) / det;
  return met;
}

namespace {

// x·y − z·w with the right sign always: exact where rounding could turn it.
double difference_of_products(double x, double y, double z, double w) {
  const double xy = x * y, zw = z * w, plain = xy - zw;
  if (std::abs(plain) > 1e-15 * (std::abs(xy) + std::abs(zw))) return plain;
  return (std::fma(x, y, -xy) - std::fma(z, w, -zw)) + plain;
}

}  // namespace

std::optional<double> crossing(const Vec3& origin, const Vec3& direction, const Vec3f& a,
                               const Vec3f& b, const Vec3f& c) {
  // Sheared so that the ray runs along +z through the origin: a vertex has one place in the plane
  // for all triangles that share it.
  int z;
  direction.cwiseAbs().maxCoeff(&z);
  const int x = (z + 1) % 3, y = (z + 2) % 3;
  const double sx = direction[x] / direction[z], sy = direction[y] / direction[z];
  const auto sheared = [&](const Vec3f& v) {
    const Vec3 p = v.cast<double>() - origin;
    return Vec3(p[x] - sx * p[z], p[y] - sy * p[z], p[z]);
  };
  const Vec3 p = sheared(a), q = sheared(b), r = sheared(c);
  const double u = difference_of_products(q[0], r[1], r[0], q[1]);
  const double v = difference_of_products(r[0], p[1], p[0], r[1]);
  const double w = difference_of_products(p[0], q[1], q[0], p[1]);
  if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return std::nullopt;
  const double sum = u + v + w;
  if (sum == 0) return std::nullopt;
  return (u / sum * p[2] + v / sum * q[2] + w / sum * r[2]) / direction[z];
}

std::array<int64_t, 3> voxel_of(const Vec3& point, double voxel_m) {
  std::array<int64_t, 3> cell{};
  for (int k = 0; k < 3; ++k) cell[size_t(k)] = int64_t(std::floor(point[k] / voxel_m));
  return cell;
}

namespace {

Met meet_ellipsoid(const elements::Model& model, const elements::Ellipsoid& e, const Vec3& origin,
                   const Vec3& direction) {
  Met met = approach(origin, direction, e.mean, e.covariance);
  if (!(met.delta2 <= model.tau * model.tau)) return {};
  if (model.voxel_m > 0 && voxel_of(origin + met.t_m * direction, model.voxel_m) !=
                               voxel_of(e.mean.cast<double>(), model.voxel_m)) {
    return {};
  }
  met.p = e.hit.p;
  if (e.density_per_m > 0) {
    const double depth = std::sqrt(2 * M_PI) * met.sigma_m * std::exp(-0.5 * met.delta2);
    met.p = -std::expm1(-double(e.density_per_m) * depth);
  }
  return met;
}

Met meet_anywhere(const elements::Model& model, uint32_t element, const Vec3& origin,
                  const Vec3& direction) {
  const elements::Kind kind = model.kind(element);
  Met met;
  if (kind == elements::Kind::kEllipsoid) {
    const size_t at = element - model.ground.size() - model.surface.size();
    met = meet_ellipsoid(model, model.ellipsoids[at], origin, direction);
    if (met.sigma_m == 0) return {};
  } else {
    const bool ground = kind == elements::Kind::kGround;
    const elements::TriangleMesh& mesh = ground ? model.ground : model.surface;
    const size_t at = ground ? element : element - model.ground.size();
    const auto& corner = mesh.triangles[at];
    const auto t = crossing(origin, direction, mesh.vertices[corner[0]], mesh.vertices[corner[1]],
                            mesh.vertices[corner[2]]);
    if (!t) return {};
    met.t_m = *t;
    met.sigma_m = mesh.range_sigma_m;
    met.p = mesh.hit[at].p;
  }
  met.element = element;
  return met;
}

bool within(const RangeLimits& limits, double t_m) {
  return t_m >= limits.min_m && t_m <= limits.max_m;
}

}  // namespace

Met meet(const elements::Model& model, uint32_t element, const Vec3& origin, const Vec3& direction,
         const RangeLimits& limits) {
  const Met met = meet_anywhere(model, element, origin, direction);
  return within(limits, met.t_m) ? met : Met{};
}

Met meet(const elements::Model& model, const elements::Instance& placed, uint32_t instance,
         uint32_t element, const Ray& ray, const RangeLimits& limits) {
  const Eigen::Quaterniond back = placed.world_from_model.rotation.conjugate();
  const double scale = placed.scale;
  const Vec3 origin = back * (ray.origin - placed.world_from_model.translation) / scale;
  Met met = meet_anywhere(model, element, origin, back * ray.direction);
  if (met.none()) return met;
  met.instance = instance;
  met.t_m *= scale;
  met.sigma_m *= scale;
  return within(limits, met.t_m) ? met : Met{};
}

}  // namespace underbrush::trace
