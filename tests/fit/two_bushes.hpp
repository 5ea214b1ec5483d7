/// \file
/// This file makes the log of a drive past a permeable bush and a dense one.
#pragma once
#include "drive_past.hpp"

namespace underbrush::test {

/// Makes a log of flat ground under a permeable bush (y = −8 m) and a dense one (y = 8 m), seen
/// from a drive past. Every beam hits a bush or the ground, or is a miss above them.
inline BeamLog drive_past_two_bushes(uint64_t seed, const Vec3& at = Vec3::Zero(),
                                     size_t beams = 60000) {
  elements::Model truth = flat_ground(60, at);
  for (int k = 0; k < 2; ++k) {
    add_bush(Vec3f(0, k ? 8.0f : -8.0f, 1.2f), Vec3(0.3, 0.3, 0.2), k ? 0.9f : 0.4f, truth);
  }
  return drive_past(truth, seed, beams, 3000, -0.4);
}

}  // namespace underbrush::test
