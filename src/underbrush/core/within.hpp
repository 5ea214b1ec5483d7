/// \file
/// A check of coordinates from outside.
#pragma once
#include <Eigen/Core>

namespace underbrush {

/// Whether all numbers of a vector or matrix are finite and less than `most` in magnitude. The
/// comparison alone does not suffice, since `maxCoeff` may leave out what is no number.
template <class Derived>
bool is_within(const Eigen::MatrixBase<Derived>& v, typename Derived::Scalar most) {
  return v.allFinite() && v.cwiseAbs().maxCoeff() < most;
}

}  // namespace underbrush
