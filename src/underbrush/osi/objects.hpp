/// \file
/// This file converts the objects of OSI's messages to those of perception, and back.
///
/// OSI numbers objects from 0, perception from 1: an object of the truth with OSI's number n has
/// the number n + 1 in `TruthObject::id` and `TrackedObject::truth_id`.
#pragma once
#include <span>
#include <string>

#include "underbrush/osi/sensor_data.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::osi {

/// The class of an object by OSI's numbers of its type. Buses, trailers, trams and trains are
/// trucks, motorcycles and scooters are cyclists, and animals are other objects. A vehicle whose
/// kind is not stated has the class that its `size_m` (length, width, height) suggests, where one
/// is given.
perception::ObjectClass class_of(uint32_t type, uint32_t vehicle_type,
                                 const std::optional<Vec3>& size_m = {});
/// OSI's numbers of the type of a class.
Candidate candidate_of(perception::ObjectClass label, double probability);

/// Fills `frame` with the road users of the truth that have a box, without the host vehicle. Throws
/// `FormatError`, which names `source`, where two have the same number.
void truth_of(const GroundTruth& truth, std::optional<uint64_t> host, std::string_view source,
              perception::TruthFrame& frame);
/// The objects of a true frame and the host vehicle, as OSI's ground truth. Lists of objects do not
/// have the host's box; it gets the length, width and height of a car.
GroundTruth ground_truth_of(const perception::TruthFrame& frame, const Pose& world_from_vehicle,
                            double time_s);
/// The number that `ground_truth_of` gives the host vehicle.
inline constexpr uint64_t kHostId = uint64_t(1) << 62;

/// Replaces the objects of the data by those of a list, in the frame of the virtual sensor that the
/// data name. Velocities are relative to it: v = Rᵀ (v_o − v_h − ω × (p_o − p_h)) with the velocity
/// and the yaw rate of the data's host. Accelerations are relative without the terms of a turning
/// frame.
void set_objects(const perception::ObjectList& list, std::span<const uint64_t> sensor_ids,
                 SensorData& data);
/// The objects of the data as a list, in the world's frame. Points and measured extents have no
/// place in OSI, so they are 0. The class is the most probable one, or unknown below a half.
perception::ObjectList list_of(const SensorData& data);

/// The lists as SensorData, with the vehicle's velocity and yaw rate from the poses of the lists
/// around each. The virtual sensor is the vehicle.
std::vector<SensorData> data_of(std::span<const perception::ObjectList> lists);

}  // namespace underbrush::osi
