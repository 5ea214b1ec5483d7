#include "underbrush/osi/read.hpp"
#include "underbrush/osi/write_parts.inl"

namespace underbrush::osi {

SensorView view_of_ground_truth(std::string_view bytes, std::string_view source) {
  const GroundTruth truth = read_ground_truth(bytes, source);
  std::string message;
  protozero::pbf_writer w(message);
  write_version(w, 1, truth.version);
  write_timestamp(w, 2, truth.timestamp);
  write_id(w, 3, 0);
  write_mounting(w, 4, Mounting::of(Pose()));
  w.add_message(7, bytes.data(), bytes.size());
  write_id(w, 8, truth.host_vehicle_id);
  return read_sensor_view(std::move(message), source);
}

}  // namespace underbrush::osi
