#include "underbrush/core/linear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace underbrush {
namespace {

template <int N>
Spectrum<N> iterated(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

Spectrum<2> spectrum(const Eigen::Matrix2d& symmetric) { return iterated<2>(symmetric); }
Spectrum<3> spectrum(const Mat3& symmetric) { return iterated<3>(symmetric); }

Vec3 eigenvalues(const Mat3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Spectrum<3> quick_spectrum(const Mat3& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vec3 quick_eigenvalues(const Mat3& symmetric) {
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  return solver.computeDirect(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Mat3 cholesky(const Mat3& sigma) { return Eigen::LLT<Mat3>(sigma).matrixL(); }

bool is_positive_definite(const Mat3& symmetric) {
  return Eigen::LLT<Mat3>(symmetric).info() == Eigen::Success;
}

Vec3 solve(const Mat3& sigma, const Vec3& b) { return sigma.ldlt().solve(b); }

Eigen::Vector4d solve(const Eigen::Matrix4d& sigma, const Eigen::Vector4d& b) {
  return sigma.ldlt().solve(b);
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& sigma) {
  return sigma.ldlt().solve(Eigen::MatrixXd::Identity(sigma.rows(), sigma.cols()));
}

Eigen::Quaterniond turn_between(const Vec3& from, const Vec3& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace underbrush
