/// \file
/// This file merges the clouds of a rig's sensors into one cloud of the vehicle (IF1 to IF2 of
/// [rosenberger20] Fig. 5).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/perception/cloud.hpp"
#include "underbrush/perception/rig.hpp"

namespace underbrush::perception {

/// The options of `Alignment`.
struct AlignmentOptions {
  /// Whether each point is moved to where the vehicle's frame stood at the point's own time. If
  /// not, all points are treated as measured at the time of the merged cloud, as in a fusion
  /// without the vehicle's motion.
  bool deskew = true;
};

/// Moves the clouds of a rig's sensors to the vehicle's frame and merges them.
///
/// A point p of sensor k with the clock's time t becomes p' = T(t₀)⁻¹ T(t − offset_k) M_k p, where
/// M_k is the sensor's mounting pose, T the vehicle's pose in the world and t₀ the time of the
/// merged cloud. Without de-skewing T(t − offset_k) is T(t₀). Points are in order of their
/// corrected time, then of sensor, then of the order in the sensor's cloud.
class Alignment {
 public:
  /// Throws `std::invalid_argument` for a rig without sensors.
  explicit Alignment(Rig rig, const AlignmentOptions& options = {});

  /// Replaces `merged` by the points of all clouds. An empty trajectory is a vehicle that stands at
  /// the world's origin. Throws `std::invalid_argument` where a cloud's columns differ in length,
  /// its sensor is not in the rig, or the trajectory has no pose for a time.
  void merge(std::span<const SensorCloud> clouds, const Trajectory& world_from_vehicle,
             double time_s, MergedCloud& merged);

  const Rig& rig() const { return rig_; }

 private:
  struct Entry {
    double time_s;
    uint32_t cloud, index;
  };
  Rig rig_;
  AlignmentOptions options_;
  std::vector<Entry> order_;
};

}  // namespace underbrush::perception
