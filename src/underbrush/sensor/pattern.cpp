#include "underbrush/sensor/pattern.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/sensor/angles.hpp"

namespace underbrush::sensor {
namespace {

// A firing within this fraction of a firing period from a boundary counts as on it.
constexpr double kSlack = 1e-6;

uint64_t revolution(const Sensor& sensor, size_t firing) {
  return uint64_t((double(firing) + kSlack) / sensor.firings_per_revolution());
}

size_t first_firing(const Sensor& sensor, uint64_t turn) {
  return size_t(std::ceil(double(turn) * sensor.firings_per_revolution() - kSlack));
}

}  // namespace

PatternSource::PatternSource(Sensor sensor, const Trajectory& trajectory, double start_s,
                             double end_s, size_t chunk_size, std::optional<double> from_s)
    : sensor_(std::move(sensor)),
      trajectory_(trajectory),
      start_s_(start_s),
      end_s_(end_s),
      from_s_(std::max(from_s.value_or(start_s), start_s)),
      chunk_size_(std::max<size_t>(1, chunk_size)) {
  sensor_.check();
  require(std::isfinite(start_s) && std::isfinite(end_s) && start_s <= end_s,
          "beams: needs finite times, start <= end");
  require_data((end_s - start_s) * sensor_.rate_hz < 4e9, "beams: too long a time");
  info_.sensor = sensor_.name;
  info_.sensor_file = sensor_.file;
  info_.min_range_m = sensor_.min_range_m;
  info_.max_range_m = sensor_.max_range_m;
  info_.has_misses = info_.deskewed = true;
  sensor_.kind == Kind::kSpinning ? start_spinning() : start_shooting();
}

void PatternSource::add_scan(uint64_t scan, double after_s) {
  const double time_s = std::max(start_s_ + after_s, from_s_);
  info_.scans.push_back({uint32_t(scan), time_s, pose(time_s)});
}

size_t PatternSource::firings_before(double time_s) const {
  return size_t(std::max(0.0, std::ceil((time_s - start_s_) / sensor_.firing_period_s - kSlack)));
}

size_t PatternSource::beams_before(double time_s) const {
  if (sensor_.kind != Kind::kSpinning) return sensor_.shots_before(time_s - start_s_);
  const size_t firings = firings_before(time_s);
  if (firings == 0) return 0;
  // Only the last firing can extend past the end.
  const double last = start_s_ + double(firings - 1) * sensor_.firing_period_s;
  return (firings - 1) * order_.size() +
         size_t(std::count_if(order_.begin(), order_.end(), [&](uint16_t c) {
           return last + sensor_.channels[c].time_s < time_s;
         }));
}

void PatternSource::start_spinning() {
  order_ = sensor_.firing_order();
  std::map<std::pair<double, double>, size_t> first_as;
  for (size_t k = 0; k < order_.size(); ++k) {
    const Channel& c = sensor_.channels[order_[k]];
    as_.push_back(first_as.try_emplace({c.time_s, c.azimuth_rad}, k).first->second);
    raised_.push_back(unit_vector(0, c.elevation_rad));
  }
  firings_ = firings_before(end_s_);
  size_ = beams_before(end_s_);
  if (firings_ == 0) return;
  const size_t first = std::min(beams_before(from_s_) / order_.size(), firings_ - 1);
  const uint64_t last = revolution(sensor_, firings_ - 1);
  for (uint64_t turn = revolution(sensor_, first); turn <= last; ++turn) {
    add_scan(turn, double(first_firing(sensor_, turn)) * sensor_.firing_period_s);
  }
}

void PatternSource::start_shooting() {
  size_ = beams_before(end_s_);
  const size_t begin = beams_before(from_s_);
  const auto passed = uint64_t((from_s_ - start_s_) * sensor_.rate_hz);
  for (uint64_t scan = std::max<uint64_t>(passed, 1) - 1;; ++scan) {
    const uint64_t first = sensor_.shots_before(double(scan) / sensor_.rate_hz);
    if (first >= size_) break;
    if (first <= begin) {
      first_scan_ = scan;
      first_shot_.clear();
      info_.scans.clear();
    }
    add_scan(scan, sensor_.shot(first).time_s);
    first_shot_.push_back(first);
  }
}

Pose PatternSource::pose(double time_s) const {
  const std::optional<Pose> found = trajectory_.at(time_s);
  require(found.has_value(), "beams: the trajectory has no pose at the time of a beam");
  return *found;
}

void PatternSource::fire(size_t firing, size_t at, BeamLog& chunk) const {
  const double t0 = double(firing) * sensor_.firing_period_s;
  const uint64_t turn = revolution(sensor_, firing);
  const size_t packet = (firing - first_firing(sensor_, turn)) / size_t(sensor_.firings_per_packet);
  double posed_at = -1;
  Pose world_from_sensor;
  std::vector<Vec3> level(order_.size());  // directions of elevation 0
  for (size_t k = 0; k < order_.size() && at + k < chunk.size(); ++k) {
    const Channel& c = sensor_.channels[order_[k]];
    const double t = t0 + c.time_s, turns = t * sensor_.rate_hz;
    if (t != posed_at) world_from_sensor = pose(start_s_ + t);
    posed_at = t;
    const double azimuth = sensor_.start_azimuth_rad + c.azimuth_rad +
                           sensor_.turn() * 2 * M_PI * (turns - std::floor(turns));
    level[k] = as_[k] == k ? unit_vector(azimuth, 0) : level[as_[k]];
    const Vec3 d = world_from_sensor.rotation * Vec3(raised_[k].x() * level[k].x(),
                                                     raised_[k].x() * level[k].y(), raised_[k].z());
    chunk.origin[at + k] = world_from_sensor * Vec3(0, 0, c.z_m);
    chunk.direction[at + k] = d.cast<float>();
    chunk.time_s[at + k] = start_s_ + t;
    chunk.ring[at + k] = order_[k];
    chunk.scan[at + k] = uint32_t(turn);
    chunk.packet[at + k] = uint32_t(packet);
  }
}

void PatternSource::shoot(size_t begin, size_t end, size_t first, BeamLog& chunk) const {
  double posed_at = -1;
  Pose world_from_sensor;
  for (size_t i = begin; i < end; ++i) {
    const uint64_t shot_number = first + i;
    const Shot s = sensor_.shot(shot_number);
    const double t = s.time_s;
    if (t != posed_at) world_from_sensor = pose(start_s_ + t);
    posed_at = t;
    const auto scan = std::upper_bound(first_shot_.begin(), first_shot_.end(), shot_number) - 1;
    const double z = s.ring < sensor_.channels.size() ? sensor_.channels[s.ring].z_m : 0;
    const Vec3 d = world_from_sensor.rotation * unit_vector(s.azimuth_rad, s.elevation_rad);
    chunk.origin[i] = world_from_sensor * Vec3(0, 0, z);
    chunk.direction[i] = d.cast<float>();
    chunk.time_s[i] = start_s_ + t;
    chunk.ring[i] = s.ring;
    chunk.scan[i] = uint32_t(first_scan_ + uint64_t(scan - first_shot_.begin()));
    chunk.packet[i] = uint32_t((shot_number - *scan) / uint64_t(sensor_.firings_per_packet));
  }
}

size_t PatternSource::seek(size_t beam) {
  const bool spinning = sensor_.kind == Kind::kSpinning;
  const size_t width = spinning ? order_.size() : 1;
  firing_ = std::min(beam / width, spinning ? firings_ : size_);
  return firing_ * width;
}

bool PatternSource::next(BeamLog& chunk) {
  chunk = BeamLog();
  chunk.info = info_;
  const size_t first = firing_;
  if (sensor_.kind != Kind::kSpinning) {
    firing_ = first + std::min(chunk_size_, size_ - first);
    chunk.resize(firing_ - first);
    parallel_for(chunk.size(), 4096,
                 [&](size_t begin, size_t end) { shoot(begin, end, first, chunk); });
    return !chunk.empty();
  }
  const size_t width = order_.size();
  const size_t n = std::min(std::max<size_t>(1, chunk_size_ / width), firings_ - first);
  firing_ += n;
  chunk.resize(firing_ == firings_ ? size_ - std::min(size_, first * width) : n * width);
  parallel_for(n, 64, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) fire(first + f, f * width, chunk);
  });
  return !chunk.empty();
}

Trajectory one_scan(const Sensor& sensor, const StampedPose& pose) {
  sensor.check();
  StampedPose last = pose;
  last.time_s += 1 / sensor.rate_hz;
  return Trajectory({pose, last});
}

BeamLog beams(const Sensor& sensor, const Trajectory& trajectory, double start_s, double end_s) {
  PatternSource source(sensor, trajectory, start_s, end_s, SIZE_MAX);
  BeamLog log;
  source.next(log);
  return log;
}

}  // namespace underbrush::sensor
