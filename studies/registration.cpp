#include "studies/registration.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <vector>

#include "studies/plane_fit.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/metrics/nearest.hpp"
#include "underbrush/metrics/normals.hpp"

namespace underbrush::studies {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

std::vector<Vec3f> about(std::span<const Vec3> points, const Vec3& centre) {
  std::vector<Vec3f> out;
  for (const Vec3& p : points) out.push_back((p - centre).cast<float>());
  return out;
}

Pose exponential(const Vector6& step) {
  const double angle = step.head<3>().norm();
  Pose out;
  if (angle > 0)
    out.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, step.head<3>() / angle));
  out.translation = step.tail<3>();
  return out;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The normal equations of a step over the pairs that count, from the distances along the normals
/// and their derivatives by a small rotation about the origin and a translation.
struct Step {
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double sum2 = 0;
  size_t pairs = 0;
};

/// The solution of least norm of normal equations, which clouds on a plane leave singular.
Vector6 least_norm_solution(const Matrix6& normal, const Vector6& right) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> of(normal);
  const double least = 1e-12 * of.eigenvalues()[5];
  const Vector6 inverse =
      of.eigenvalues().unaryExpr([&](double v) { return v > least ? 1 / v : 0.0; });
  return of.eigenvectors() * (inverse.asDiagonal() * (of.eigenvectors().transpose() * right));
}

}  // namespace

Similarity align(std::span<const Vec3> from, std::span<const Vec3> to, bool rigid) {
  require(from.size() == to.size(), "conjugate points: as many on both sides are needed");
  require(from.size() >= 3, "conjugate points: at least three are needed");
  const Vec3 from_mean = mean_of(from), to_mean = mean_of(to);
  Mat3 between = Mat3::Zero();
  double spread = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const Vec3 a = from[i] - from_mean;
    between += (to[i] - to_mean) * a.transpose();
    spread += a.squaredNorm();
  }
  const Eigen::JacobiSVD<Mat3> of(between, Eigen::ComputeFullU | Eigen::ComputeFullV);
  require(of.singularValues().y() > 1e-12 * of.singularValues().x(),
          "conjugate points: they lie on a line");
  const bool mirrors = (of.matrixU() * of.matrixV().transpose()).determinant() < 0;
  const Mat3 rotation =
      of.matrixU() * Vec3(1, 1, mirrors ? -1 : 1).asDiagonal() * of.matrixV().transpose();
  Similarity out;
  out.pose.rotation = Eigen::Quaterniond(rotation).normalized();
  out.scale = rigid ? 1 : rotation.cwiseProduct(between).sum() / spread;
  out.pose.translation = to_mean - out.scale * (rotation * from_mean);
  return out;
}

IcpResult icp(std::span<const Vec3> from, std::span<const Vec3> to, const Pose& guess,
              const IcpOptions& options) {
  require(from.size() >= 10 && to.size() >= 10, "icp: clouds of at least ten points are needed");
  const Vec3& centre = to[to.size() / 2];
  const std::vector<Vec3f> cloud = about(to, centre);
  const std::vector<Vec3f> normal = metrics::normals(cloud, size_t(options.neighbours));
  IcpResult out;
  out.to_from_from = guess;
  std::vector<Vec3> moved(from.size());
  while (out.iterations < options.most_iterations && !out.converged) {
    for (size_t i = 0; i < from.size(); ++i) moved[i] = out.to_from_from * from[i];
    const std::vector<Vec3f> query = about(moved, centre);
    const metrics::Nearest pair = metrics::nearest(query, cloud);
    std::vector<double> off(from.size());
    for (size_t i = 0; i < from.size(); ++i) off[i] = double(pair.distance_m[i]);
    const double gate = std::min(options.most_distance_m, std::max(1e-3, 3 * median_of(off)));
    Step step;
    for (size_t i = 0; i < from.size(); ++i) {
      if (off[i] > gate) continue;
      const Vec3 p = query[i].cast<double>(), n = normal[pair.index[i]].cast<double>();
      const double r = n.dot(p - cloud[pair.index[i]].cast<double>());
      Vector6 row;
      row << p.cross(n), n;
      step.normal += row * row.transpose();
      step.right -= row * r;
      step.sum2 += r * r;
      ++step.pairs;
    }
    require(step.pairs >= 6, "icp: the clouds have nothing in common");
    const Vector6 x = least_norm_solution(step.normal, step.right);
    const Pose shift{Eigen::Quaterniond::Identity(), centre};
    out.to_from_from = shift * exponential(x) * shift.inverse() * out.to_from_from;
    out.rms_m = std::sqrt(step.sum2 / double(step.pairs));
    out.overlap = double(step.pairs) / double(from.size());
    out.converged = x.head<3>().norm() < 1e-6 && x.tail<3>().norm() < 1e-6;
    ++out.iterations;
  }
  return out;
}

}  // namespace underbrush::studies
