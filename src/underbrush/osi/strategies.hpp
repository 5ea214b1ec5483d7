/// \file
/// The makers of our strategies. This file is internal to the module.
#pragma once
#include "underbrush/osi/strategy.hpp"
#include "underbrush/perception/cloud.hpp"

namespace underbrush::osi {

/// Answers the rays of a lidar from the ground truth.
std::unique_ptr<Strategy> make_tracer(Parameters& parameters);
/// Turns reflections into detections.
std::unique_ptr<Strategy> make_front_end(Parameters& parameters);
/// Moves detections to the frame of the virtual sensor.
std::unique_ptr<Strategy> make_alignment(Parameters& parameters);
/// Turns detections into tracked objects.
std::unique_ptr<Strategy> make_tracking(Parameters& parameters);
/// Estimates the classes of objects.
std::unique_ptr<Strategy> make_classification(Parameters& parameters);
/// Maps the free area.
std::unique_ptr<Strategy> make_grid(Parameters& parameters);
/// A strategy of a shared library, whose interface is strategy_library.h.
std::unique_ptr<Strategy> load_strategy(const StrategyEntry& entry);

/// The world's pose of the vehicle's frame on the ground below the rear axle, as perception has it.
Pose world_from_ground(const SensorData& data, double axle_height_m);
/// Fills a cloud with the detections of the data, in the vehicle's frame on the ground below the
/// rear axle. With `misses` it has the ends of the beams without a detection, too, at `reach_m`.
void cloud_of(const SensorData& data, double axle_height_m, bool misses, double reach_m,
              perception::MergedCloud& cloud);
/// The time of the data's last measurement, else of the data, s.
double measured_s(const SensorData& data);

}  // namespace underbrush::osi
