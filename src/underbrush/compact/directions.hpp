/// \file
/// Directions of beams, coded as their residuals from a scan pattern.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "underbrush/compact/scratch.hpp"

namespace underbrush::compact {

/// The data of the beams of a chunk that are decoded before their directions, in order of rows.
struct Fired {
  std::span<const uint16_t> ring;
  std::span<const uint32_t> scan;
  std::span<const double> time_s;
  std::span<const Place> place;  ///< The sensor's place by the track; empty where there is none.
  const Order& by_ring;
};

/// Appends unit vectors. The beams of one ring and scan are taken to have one elevation and an
/// azimuth that is linear in time or in their number; the differences from that are whole numbers
/// of floats.
void pack_directions(std::span<const Vec3f> direction, const Fired& fired, Scratch& scratch,
                     std::string& out);
/// Reads what `pack_directions` wrote for the same beams.
void unpack_directions(Cursor& in, const Fired& fired, Scratch& scratch,
                       std::span<Vec3f> direction);

}  // namespace underbrush::compact
