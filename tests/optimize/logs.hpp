/// This file makes logs for the tests of tuning.
#pragma once
#include "drive_past.hpp"

namespace underbrush::test {

/// Makes `scans` turns, one a second, of a sensor that drives past two rows of permeable bushes.
inline BeamLog drive_past_bushes(uint64_t seed, uint32_t scans, size_t beams_of_scan = 1500) {
  elements::Model truth = flat_ground(40);
  for (int k = 0; k < 24; ++k) {
    add_bush(Vec3f(-6 + 0.5f * float(k), k % 2 ? 6.0f : -6.0f, 0.4f + 0.2f * float(k % 5)),
             Vec3(0.05, 0.05, 0.03), k % 2 ? 0.9f : 0.4f, truth);
  }
  return drive_past(truth, seed, scans * beams_of_scan, beams_of_scan, -0.3);
}

}  // namespace underbrush::test
