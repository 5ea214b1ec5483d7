/// \file
/// The geometry of one beam.
#pragma once
#include "underbrush/core/pose.hpp"

namespace underbrush {

/// A ray o + t d with `direction` d of unit length, so that t is a range (m).
struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::UnitX();

  Vec3 at(double t) const { return origin + t * direction; }
};

}  // namespace underbrush
