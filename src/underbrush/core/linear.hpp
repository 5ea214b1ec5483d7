/// \file
/// Linear algebra of small matrices, compiled once: where Eigen's templates for it are used, they
/// take seconds of a compiler's time.
#pragma once
#include "underbrush/core/pose.hpp"

namespace underbrush {

/// The eigenvalues of a symmetric matrix in ascending order, and its eigenvectors as columns.
template <int N>
struct Spectrum {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};

/// The eigenvalues and eigenvectors of a symmetric matrix, iterated to full precision.
Spectrum<2> spectrum(const Eigen::Matrix2d& symmetric);
/// Does so in three dimensions.
Spectrum<3> spectrum(const Mat3& symmetric);
/// The eigenvalues alone, to full precision.
Vec3 eigenvalues(const Mat3& symmetric);
/// Solves the characteristic equation: several times faster, and less precise where eigenvalues are
/// nearly equal.
Spectrum<3> quick_spectrum(const Mat3& symmetric);
/// The eigenvalues alone, as fast.
Vec3 quick_eigenvalues(const Mat3& symmetric);

/// The lower factor L of Cholesky's decomposition Σ = L Lᵀ of a positive definite matrix.
Mat3 cholesky(const Mat3& sigma);
/// Whether all eigenvalues are positive.
bool is_positive_definite(const Mat3& symmetric);

/// The solution x of Σ x = b for a positive definite matrix, by Cholesky's decomposition with
/// pivots.
Vec3 solve(const Mat3& sigma, const Vec3& b);
/// Does so in four dimensions.
Eigen::Vector4d solve(const Eigen::Matrix4d& sigma, const Eigen::Vector4d& b);
/// The inverse of a positive definite matrix, by the same decomposition.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& sigma);

/// The rotation by the least angle that turns the direction of `from` into that of `to`.
Eigen::Quaterniond turn_between(const Vec3& from, const Vec3& to);

}  // namespace underbrush
