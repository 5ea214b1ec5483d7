#include "underbrush/metrics/normals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::metrics {
namespace {

/// Computes the eigenvector of a single eigenvalue. All cross products of rows of Σ − λ 1 are along
/// it, and the longest one is taken.
Vec3 single_eigenvector(const Mat3& sigma, double lambda) {
  const Mat3 m = sigma - lambda * Mat3::Identity();
  const Vec3 a = m.row(0), b = m.row(1), c = m.row(2);
  Vec3 longest = a.cross(b);
  for (const Vec3& other : {Vec3(a.cross(c)), Vec3(b.cross(c))}) {
    if (other.squaredNorm() > longest.squaredNorm()) longest = other;
  }
  return longest.normalized();
}

/// Computes the eigenvector of `lambda` in the plane perpendicular to the eigenvector `first`.
Vec3 second_eigenvector(const Mat3& sigma, const Vec3& first, double lambda) {
  Vec3 u = std::abs(first.x()) > std::abs(first.y()) ? Vec3(-first.z(), 0, first.x()).normalized()
                                                     : Vec3(0, first.z(), -first.y()).normalized();
  const Vec3 v = first.cross(u);
  const double m00 = u.dot(sigma * u) - lambda, m01 = u.dot(sigma * v),
               m11 = v.dot(sigma * v) - lambda;
  const bool upper = std::abs(m00) >= std::abs(m11);
  const double diagonal = upper ? m00 : m11;
  const double larger = std::abs(diagonal) >= std::abs(m01) ? diagonal : m01;
  if (larger == 0) return u;
  const double length = std::copysign(std::hypot(diagonal, m01), larger);
  return (upper ? Vec3(m01 * u - m00 * v) : Vec3(m11 * u - m01 * v)) / length;
}

/// Computes the direction of least spread. It begins with the well separated end of the spectrum:
/// the middle eigenvalue is nearer to the least than to the greatest one iff det(Σ − tr Σ/3) ≥ 0.
Vec3 least_spread(Mat3 sigma) {
  const double most = sigma.maxCoeff();
  if (!(most > 0)) return Vec3::UnitZ();
  sigma /= most;
  const Vec3 values = eigenvalues(sigma);
  const Mat3 off = sigma - sigma.trace() / 3 * Mat3::Identity();
  if (off.determinant() < 0) {
    const Vec3 n = single_eigenvector(sigma, values[0]);
    return n.allFinite() && n.squaredNorm() > 0.5 ? n : Vec3(Vec3::UnitZ());
  }
  const Vec3 greatest = single_eigenvector(sigma, values[2]);
  return second_eigenvector(sigma, greatest, values[1]).cross(greatest);
}

}  // namespace

std::vector<Vec3f> normals(std::span<const Vec3f> cloud, size_t k) {
  require(k >= 3, "a normal needs at least three neighbours");
  std::vector<Vec3f> out(cloud.size(), Vec3f::UnitZ());
  if (cloud.size() < 3) return out;
  k = std::min(k, cloud.size());
  const CloudTree tree(cloud);
  parallel_for(cloud.size(), 2048, [&](size_t begin, size_t end) {
    std::vector<uint32_t> index(k);
    std::vector<float> squared(k);
    for (size_t i = begin; i < end; ++i) {
      const size_t found = tree.nearest(cloud[i].data(), k, index.data(), squared.data());
      Vec3 mean = Vec3::Zero();
      for (size_t j = 0; j < found; ++j) mean += cloud[index[j]].cast<double>();
      mean /= double(found);
      Mat3 sigma = Mat3::Zero();
      for (size_t j = 0; j < found; ++j) {
        const Vec3 d = cloud[index[j]].cast<double>() - mean;
        sigma += d * d.transpose();
      }
      out[i] = least_spread(sigma).cast<float>();
    }
  });
  return out;
}

}  // namespace underbrush::metrics
