/// \file
/// This file decodes OSI's messages.
///
/// All functions accept messages of OSI 3.0 to 3.8: unknown fields are passed over, as the wire
/// format demands. They throw `FormatError`, which names `source` and the field, for bytes that are
/// not a message, for numbers that are not finite, and for values that make no sense (negative
/// extents, nanoseconds of a second or more, another major version). No input makes them fail
/// otherwise, except for want of memory.
#pragma once
#include <string>
#include <string_view>

#include "underbrush/osi/sensor_data.hpp"

namespace underbrush::osi {

/// Decodes a GroundTruth.
GroundTruth read_ground_truth(std::string_view bytes, std::string_view source);
/// Decodes a SensorView. It takes the bytes over, into `SensorView::bytes`.
SensorView read_sensor_view(std::string bytes, std::string_view source);
/// The SensorView that carries an encoded GroundTruth, with its version, time and host vehicle.
SensorView view_of_ground_truth(std::string_view bytes, std::string_view source);
/// Decodes a SensorData.
SensorData read_sensor_data(std::string_view bytes, std::string_view source);
/// Decodes a SensorViewConfiguration.
SensorViewConfiguration read_configuration(std::string_view bytes, std::string_view source);

}  // namespace underbrush::osi
