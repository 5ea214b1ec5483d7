// Writers of parts that several messages have.
#pragma once
#include <protozero/pbf_writer.hpp>
#include <string>

#include "underbrush/osi/sensor_view.hpp"

namespace underbrush::osi {

/// Writes a field that is a message with `write(writer)`.
template <class Write>
void write_part(protozero::pbf_writer& w, uint32_t tag, Write&& write) {
  protozero::pbf_writer part(w, tag);
  write(part);
}

/// The same for a field that OSI's rules want to be set: a `pbf_writer` leaves out empty messages.
template <class Write>
void write_required(protozero::pbf_writer& w, uint32_t tag, Write&& write) {
  std::string bytes;
  protozero::pbf_writer part(bytes);
  write(part);
  w.add_message(tag, bytes);
}

void write_version(protozero::pbf_writer& w, uint32_t tag, const std::optional<Version>& value);
void write_timestamp(protozero::pbf_writer& w, uint32_t tag, const std::optional<Timestamp>& value);
void write_id(protozero::pbf_writer& w, uint32_t tag, const std::optional<uint64_t>& value);
/// Writes an identifier unless it is `kNoId`.
void write_known_id(protozero::pbf_writer& w, uint32_t tag, uint64_t id);
void write_vector(protozero::pbf_writer& w, uint32_t tag, const std::optional<Vec3>& value);
void write_number(protozero::pbf_writer& w, uint32_t tag, const std::optional<double>& value);
void write_count(protozero::pbf_writer& w, uint32_t tag, const std::optional<uint32_t>& value);
void write_mounting(protozero::pbf_writer& w, uint32_t tag, const std::optional<Mounting>& value);
void write_base(protozero::pbf_writer& w, uint32_t tag, const BaseMoving& base);
void write_view(protozero::pbf_writer& w, const SensorView& view);
void write_lidar_configuration(protozero::pbf_writer& w, uint32_t tag,
                               const LidarConfiguration& configuration);

}  // namespace underbrush::osi
