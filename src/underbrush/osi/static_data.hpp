/// \file
/// This file keeps what simulators send once only.
#pragma once
#include "underbrush/osi/sensor_view.hpp"

namespace underbrush::osi {

/// The parts of SensorViews that do not change. Some simulators send them in the first message only
/// (`omit_static_information`): the version, the number of the host vehicle, and where its rear
/// axle is.
class StaticData {
 public:
  /// `version` is that of views before one has told it.
  explicit StaticData(std::optional<Version> version = {}) : version_(version) {}
  /// Fills in what the view lacks and an earlier one had, also in its bytes.
  void fill(SensorView& view);

 private:
  std::optional<Version> version_;
  std::optional<uint64_t> host_;
  std::optional<Vec3> centre_to_rear_m_;
};

}  // namespace underbrush::osi
