#include "underbrush/perception/rig_source.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::perception {
namespace {

// The poses of a sensor that is fixed to a vehicle.
Trajectory moved(const Trajectory& world_from_vehicle, const Pose& vehicle_from_sensor) {
  std::vector<StampedPose> poses = world_from_vehicle.poses();
  for (StampedPose& p : poses) p.world_from_sensor = p.world_from_sensor * vehicle_from_sensor;
  return Trajectory(std::move(poses));
}

}  // namespace

std::vector<sensor::Sensor> sensors_of(const Rig& rig) {
  std::vector<sensor::Sensor> sensors;
  for (const MountedSensor& m : rig.sensors) sensors.push_back(sensor::load(m.sensor));
  return sensors;
}

/// The beams of one sensor, and the next of them.
struct RigSource::Stream {
  Trajectory path;
  sensor::PatternSource source;
  BeamLog chunk;
  size_t at = 0;
  bool is_done = false;

  Stream(const sensor::Sensor& sensor, Trajectory poses, size_t chunk_size)
      : path(std::move(poses)),
        source(sensor, path, path.poses().front().time_s, path.poses().back().time_s, chunk_size) {
    read();
  }
  void read() {
    at = 0;
    is_done = !source.next(chunk);
  }
  void rewind() {
    source.rewind();
    read();
  }
  void advance() {
    if (++at == chunk.size()) read();
  }
  double time_s() const { return chunk.time_s[at]; }
};

RigSource::RigSource(const Rig& rig, const Trajectory& world_from_vehicle, size_t chunk_size)
    : sensors_(sensors_of(rig)), chunk_size_(std::max<size_t>(chunk_size, 1)) {
  require(!rig.sensors.empty(), "rig: it has no sensor");
  const auto& poses = world_from_vehicle.poses();
  require(poses.size() >= 2, "rig: a trajectory needs at least two poses");
  start_s_ = poses.front().time_s;
  info_.min_range_m = sensors_[0].min_range_m;
  info_.max_range_m = sensors_[0].max_range_m;
  info_.has_misses = info_.deskewed = true;
  for (size_t k = 0; k < sensors_.size(); ++k) {
    info_.min_range_m = std::min(info_.min_range_m, sensors_[k].min_range_m);
    info_.max_range_m = std::max(info_.max_range_m, sensors_[k].max_range_m);
    streams_.push_back(std::make_unique<Stream>(
        sensors_[k], moved(world_from_vehicle, rig.sensors[k].vehicle_from_sensor), 1 << 14));
  }
  const double period = 1 / sensors_[0].rate_hz;
  for (uint32_t cycle = 0;; ++cycle) {
    const double t = start_s_ + cycle * period;
    if (cycle > 0 && t >= poses.back().time_s) break;
    info_.scans.push_back({cycle, t, *world_from_vehicle.at(t)});
  }
}

RigSource::~RigSource() = default;

size_t RigSource::size() const {
  size_t sum = 0;
  for (const auto& s : streams_) sum += s->source.size();
  return sum;
}

void RigSource::rewind() {
  for (auto& s : streams_) s->rewind();
}

const RigSource::Stream* RigSource::earliest() const {
  const Stream* first = nullptr;
  for (const auto& s : streams_) {
    if (!s->is_done && (!first || s->time_s() < first->time_s())) first = s.get();
  }
  return first;
}

bool RigSource::next(BeamLog& chunk) {
  chunk = BeamLog();
  chunk.info = info_;
  std::vector<uint8_t> sensor;
  const auto last = uint32_t(info_.scans.size() - 1);
  while (chunk.size() < chunk_size_) {
    const Stream* from = earliest();
    if (!from) break;
    size_t k = 0;
    while (streams_[k].get() != from) ++k;
    chunk.append(from->chunk, from->at);
    const size_t i = chunk.size() - 1;
    const double cycles = (chunk.time_s[i] - start_s_) * sensors_[0].rate_hz;
    chunk.scan[i] = std::min(uint32_t(std::max(cycles + 1e-9, 0.0)), last);
    chunk.packet[i] = chunk.packet[i] * uint32_t(streams_.size()) + uint32_t(k);
    sensor.push_back(uint8_t(k));
    streams_[k]->advance();
  }
  chunk.extra[kSensorColumn] = std::move(sensor);
  return !chunk.empty();
}

}  // namespace underbrush::perception
