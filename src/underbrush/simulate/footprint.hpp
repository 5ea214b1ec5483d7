/// \file
/// A lidar in a world of fine opaque geometry: the "reality" of generated sites and studies.
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
  sensor::BeamShape shape = sensor::round_beam(0.003, 0.01);  ///< Of 3 mrad, from 10 mm.
  int sub_rays = 9;             ///< Rays a beam: `sensor::spread_sub_rays`, turned at random.
  double pulse_m = 0.3;         ///< Hits nearer together than this along the beam are one echo.
  double threshold = 0.2;       ///< An echo is seen if it holds this share of the footprint.
  double range_sigma_m = 0.02;  ///< Noise of the range.
  bool element_ids = false;     ///< Add the extra column `element`: of the echo's first hit.
};

/// Answers beams in place from the triangles of `world`, whatever their hit probability: sub-rays
/// over the footprint, hits grouped into echoes, the one with most sub-rays reported (the nearer of
/// equals) at its mean range plus noise; a miss if none holds `threshold` of the sub-rays. `label`,
/// one per element of the world, comes out as the extra column `class` (of the echo's first hit; 0
/// for a miss). With an encoder's step in `shape` the true azimuth lies within it, evenly, and the
/// direction in the log is what the encoder says. Random numbers as in `simulate`.
void scan(const trace::World& world, std::span<const elements::Class> label,
          const FootprintOptions& options, size_t first_beam, BeamLog& beams);

}  // namespace underbrush::simulate
