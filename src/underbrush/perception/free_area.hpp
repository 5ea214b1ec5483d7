/// \file
/// This file finds the area around a vehicle that an occupancy grid shows to be free.
#pragma once
#include <vector>

#include "underbrush/perception/occupancy_grid.hpp"

namespace underbrush::perception {

/// The options of `find_free_area`.
struct FreeAreaOptions {
  uint32_t bearings = 180;        ///< Corners of the outline, from 3 on.
  double free_probability = 0.6;  ///< A cell is free from this probability on.
  double own_vehicle_m = 3;       ///< Cells this near are free: no beam passes below the vehicle.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// Finds the length of the free cells along each bearing, from the vehicle's x axis on and counter-
/// clockwise. Writes the corners of the outline, m, world's frame, in the vehicle's plane.
void find_free_area(const OccupancyGrid& grid, const Pose& world_from_vehicle,
                    const FreeAreaOptions& options, std::vector<Vec3>& outline);

}  // namespace underbrush::perception
