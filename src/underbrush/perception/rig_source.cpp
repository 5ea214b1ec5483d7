#include "underbrush/perception/rig_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/beam_window.hpp"
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

FiringTime whole_time(const Trajectory& world_from_vehicle) {
  const auto& poses = world_from_vehicle.poses();
  require(poses.size() >= 2, "rig: a trajectory needs at least two poses");
  return {poses.front().time_s, poses.front().time_s, poses.back().time_s};
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
  sensor::PatternSource pattern;
  size_t first;
  BeamWindow source;
  BeamLog chunk;
  size_t at = 0;
  bool is_done = false;

  Stream(const sensor::Sensor& sensor, Trajectory poses, const FiringTime& t, size_t chunk_size)
      : path(std::move(poses)),
        pattern(sensor, path, t.start_s, t.until_s, chunk_size, t.from_s),
        first(pattern.beams_before(t.from_s)),
        source(pattern, first, SIZE_MAX) {
    rewind();
  }
  void read() {
    at = 0;
    is_done = !source.next(chunk);
  }
  void rewind() {
    source.rewind();
    read();
  }
  void advance(size_t rows) {
    at += rows;
    if (at == chunk.size()) read();
  }
  double time_s() const { return chunk.time_s[at]; }
};

RigSource::RigSource(const Rig& rig, const Trajectory& world_from_vehicle, size_t chunk_size)
    : RigSource(rig, sensors_of(rig), world_from_vehicle, whole_time(world_from_vehicle),
                chunk_size) {}

RigSource::RigSource(const Rig& rig, std::vector<sensor::Sensor> sensors,
                     const Trajectory& world_from_vehicle, const FiringTime& time,
                     size_t chunk_size)
    : sensors_(std::move(sensors)),
      start_s_(time.start_s),
      chunk_size_(std::max<size_t>(chunk_size, 1)) {
  require(!rig.sensors.empty(), "rig: it has no sensor");
  info_.min_range_m = sensors_[0].min_range_m;
  info_.max_range_m = sensors_[0].max_range_m;
  info_.has_misses = info_.deskewed = true;
  for (size_t k = 0; k < sensors_.size(); ++k) {
    info_.min_range_m = std::min(info_.min_range_m, sensors_[k].min_range_m);
    info_.max_range_m = std::max(info_.max_range_m, sensors_[k].max_range_m);
    streams_.push_back(std::make_unique<Stream>(
        sensors_[k], moved(world_from_vehicle, rig.sensors[k].vehicle_from_sensor), time, 1 << 14));
  }
  const double period = 1 / sensors_[0].rate_hz;
  for (auto cycle = uint32_t((time.from_s - start_s_) / period + 1e-9);; ++cycle) {
    const double t = std::max(start_s_ + cycle * period, time.from_s);
    if (!info_.scans.empty() && t >= time.until_s) break;
    info_.scans.push_back({cycle, t, *world_from_vehicle.at(t)});
  }
  last_scan_ = info_.scans.back().scan;
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

std::vector<size_t> RigSource::fired_before() const {
  std::vector<size_t> out;
  for (const auto& s : streams_) out.push_back(s->first);
  return out;
}

std::optional<size_t> RigSource::earliest() const {
  std::optional<size_t> first;
  for (size_t k = 0; k < streams_.size(); ++k) {
    if (streams_[k]->is_done) continue;
    if (!first || streams_[k]->time_s() < streams_[*first]->time_s()) first = k;
  }
  return first;
}

size_t RigSource::beams_in_a_row(size_t k) const {
  double before_s = std::numeric_limits<double>::infinity(), until_s = before_s;
  for (size_t other = 0; other < streams_.size(); ++other) {
    if (other == k || streams_[other]->is_done) continue;
    double& limit =
        other < k ? before_s : until_s;  // Of beams at a time, the first sensor's is first.
    limit = std::min(limit, streams_[other]->time_s());
  }
  const std::vector<double>& time_s = streams_[k]->chunk.time_s;
  size_t end = streams_[k]->at + 1;
  while (end < time_s.size() && time_s[end] < before_s && time_s[end] <= until_s) ++end;
  return end - streams_[k]->at;
}

bool RigSource::next(BeamLog& chunk) {
  chunk = BeamLog();
  chunk.info = info_;
  std::vector<uint8_t> sensor;
  while (chunk.size() < chunk_size_) {
    const std::optional<size_t> k = earliest();
    if (!k) break;
    Stream& from = *streams_[*k];
    const size_t begin = chunk.size();
    const size_t rows = std::min(beams_in_a_row(*k), chunk_size_ - begin);
    chunk.append(from.chunk, from.at, from.at + rows);
    for (size_t i = begin; i < chunk.size(); ++i) {
      const double cycles = (chunk.time_s[i] - start_s_) * sensors_[0].rate_hz;
      chunk.scan[i] = std::min(uint32_t(std::max(cycles + 1e-9, 0.0)), last_scan_);
      chunk.packet[i] = chunk.packet[i] * uint32_t(streams_.size()) + uint32_t(*k);
    }
    sensor.resize(chunk.size(), uint8_t(*k));
    from.advance(rows);
  }
  chunk.extra[kSensorColumn] = std::move(sensor);
  return !chunk.empty();
}

}  // namespace underbrush::perception
