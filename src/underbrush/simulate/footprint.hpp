/// \file
/// This file simulates a lidar in a world of fine opaque geometry, which serves as the reality of
/// generated sites and studies.
#pragma once
#include <cstdint>
#include <span>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/sensor/beam.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// A beam with a footprint, and a receiver that reports the strongest echo.
struct FootprintOptions {
  uint64_t seed = 1;
  sensor::BeamShape shape = sensor::round_beam(0.003, 0.01);  ///< 3 mrad wide, 10 mm at the exit.
  int sub_rays = 9;             ///< Rays per beam, by `sensor::spread_sub_rays`, rotated at random.
  double pulse_m = 0.3;         ///< Hits nearer together than this along the beam are one echo.
  double threshold = 0.2;       ///< Least share of the footprint in a reported echo.
  double range_sigma_m = 0.02;  ///< Noise of the range.
  /// Whether to add the extra column `element`, which is that of the echo's first hit.
  bool element_ids = false;
};

/// Answers beams in place from the triangles of `world`, whatever their hit probability.
///
/// Sub-rays sample the footprint, and their hits are grouped into echoes. The echo with the most
/// sub-rays (the nearer of equals) is reported at its mean range plus noise; if it holds less than
/// `threshold` of the sub-rays, the beam is a miss. With an encoder's step in `shape`, the true
/// azimuth is spread evenly within it, and the direction in the log is that of the encoder.
///
/// `label` has one entry for each element of the world. The extra column `class` gets that of the
/// echo's first hit, 0 for a miss. `first_beam` is the number of the first beam. Beam i draws its
/// random numbers from (seed, scan, first_beam + i), as in `simulate`.
void scan(const trace::World& world, std::span<const elements::Class> label,
          const FootprintOptions& options, size_t first_beam, BeamLog& beams);

}  // namespace underbrush::simulate
