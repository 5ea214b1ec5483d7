/// \file
/// This file keeps the data that simulators send only once.
#pragma once
#include "underbrush/osi/sensor_view.hpp"

namespace underbrush::osi {

/// The parts of SensorViews that do not change. Some simulators send them in the first message only
/// (`omit_static_information`): the version, the number of the host vehicle, and the place of its
/// rear axle.
class StaticData {
 public:
  /// `version` is that of the views before the first one that has a version.
  explicit StaticData(std::optional<Version> version = {}) : version_(version) {}
  /// Fills in the data that an earlier view had and this one lacks; its bytes get all but the axle.
  void fill(SensorView& view);

 private:
  std::optional<Version> version_;
  std::optional<uint64_t> host_;
  std::optional<Vec3> centre_to_rear_m_;
};

}  // namespace underbrush::osi
