#include "studies/plane_fit.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"

namespace underbrush::studies {
namespace {

constexpr double kFlat = 1e-12;  // Below this determinant of the normal matrix the points lie on a
                                 // line.

}  // namespace

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / double(points.size());
}

double HeightPlane::distance(const Vec3& p) const {
  const double a = parameters.x(), b = parameters.y();
  return (p.z() - a * p.x() - b * p.y() - parameters.z()) / std::sqrt(1 + a * a + b * b);
}

HeightPlane fit_height_plane(std::span<const Vec3> points) {
  require(points.size() > 3, "a plane needs more than three points");
  // About the mean the normal matrix is well conditioned, and c is uncorrelated there.
  const Vec3 centre = mean_of(points);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Vec3& p : points) {
    const Vec3 d = p - centre;
    normal += d.head<2>() * d.head<2>().transpose();
    right += d.head<2>() * d.z();
  }
  require(normal.determinant() > kFlat * normal.trace() * normal.trace(),
          "a plane needs points whose x and y do not lie on a line");
  const Eigen::Matrix2d inverse = normal.inverse();
  const Eigen::Vector2d slope = inverse * right;
  HeightPlane out;
  out.parameters << slope, centre.z() - slope.dot(centre.head<2>());
  for (const Vec3& p : points) {
    const double v = p.z() - slope.dot(p.head<2>()) - out.parameters.z();
    out.variance += v * v;
  }
  out.variance /= double(points.size() - 3);
  const Eigen::Vector2d cross = -inverse * centre.head<2>();
  out.covariance.topLeftCorner<2, 2>() = inverse;
  out.covariance.topRightCorner<2, 1>() = cross;
  out.covariance.bottomLeftCorner<1, 2>() = cross.transpose();
  out.covariance(2, 2) =
      1 / double(points.size()) + centre.head<2>().dot(inverse * centre.head<2>());
  out.covariance *= out.variance;
  return out;
}

Plane fit_plane(std::span<const Vec3> points) {
  require(points.size() > 3, "a plane needs more than three points");
  Plane out;
  out.centre = mean_of(points);
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : points) scatter += (p - out.centre) * (p - out.centre).transpose();
  const Spectrum<3> axes = spectrum(scatter);
  require(axes.values.y() > kFlat * axes.values.z(),
          "a plane needs points that do not lie on a line");
  out.normal = axes.vectors.col(0);
  Eigen::Index largest;
  out.normal.cwiseAbs().maxCoeff(&largest);
  if (out.normal[largest] < 0) out.normal = -out.normal;
  out.u = axes.vectors.col(2);
  out.v = out.normal.cross(out.u);
  out.offset_m = out.normal.dot(out.centre);
  const double n = double(points.size());
  for (const Vec3& p : points) out.variance += std::pow(out.normal.dot(p - out.centre), 2);
  out.variance /= n - 3;
  out.covariance.diagonal() << 1 / n, 1 / axes.values.z(), 1 / axes.values.y();
  out.covariance *= out.variance;
  return out;
}

Vec3 intersection(const Plane& a, const Plane& b, const Plane& c) {
  Mat3 normals;
  normals << a.normal.transpose(), b.normal.transpose(), c.normal.transpose();
  require(std::abs(normals.determinant()) > 1e-6, "three planes, two of them parallel");
  return normals.inverse() * Vec3(a.offset_m, b.offset_m, c.offset_m);
}

}  // namespace underbrush::studies
