/// \file
/// The scans for tests of extrapolation: those of a drive that train a model, and those that test
/// it where the sensor goes on, or comes back.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// The scans of a drive in order, and the distance that the sensor had gone at each (m).
struct Path {
  std::vector<uint32_t> scan;
  std::vector<double> at_m;
  std::vector<Vec3> place;  ///< m, world.
};
/// Returns the path through the scans' poses.
Path path_of(std::span<const ScanInfo> scans);

/// A stretch of a drive to learn from, and scans to answer.
struct Continuation {
  std::vector<uint32_t> train;   ///< Every second scan of the stretch.
  std::vector<uint32_t> inside;  ///< Up to three of the scans between them, about its middle.
  /// The scans at this distance (m) beyond its end, to within 1 m.
  std::map<int, std::vector<uint32_t>> beyond;
};
/// Returns stretches of 30 m that begin at the start of the drive and every 50 m after it, with the
/// scans 5, 10 and 20 m beyond. A shorter drive has one stretch that ends 5.5 m before its end; it
/// has none if less than 3 m remain.
std::vector<Continuation> continuations(const Path& path);

/// A place that a drive passes twice: the scans of the first time, and those of the second.
struct SecondPass {
  std::vector<uint32_t> train, test;
};
/// Returns the scans of the second pass, which stand within 3 m of a scan at least 50 m of way
/// earlier, and all scans before the first of them; nothing where the drive never comes back.
std::optional<SecondPass> second_pass(const Path& path);

}  // namespace underbrush::studies
