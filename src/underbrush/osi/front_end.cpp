#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/osi/profile.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/radiometry/receiver.hpp"

namespace underbrush::osi {
namespace {

using radiometry::Echo;
using radiometry::Echoes;

constexpr size_t kBeamsABlock = 256;

struct FrontEndOptions {
  radiometry::ReceiverOptions receiver;
  sensor::Intensity intensity = sensor::Intensity::kReflectance;
  double percent = 1;  // Of an intensity of 1.
  double reference_db = 0;
  size_t rays_per_beam = 0;
  uint64_t seed = 1;
};

/// Turns reflections into the echoes of a receiver.
class FrontEnd : public Strategy {
 public:
  FrontEnd(const FrontEndOptions& options, std::shared_ptr<const Profile> profile)
      : options_(options),
        profile_(std::move(profile)),
        receiver_(std::make_shared<const radiometry::Receiver>(options.receiver)) {}

  void step(SensorData& data) override {
    data.lidar.clear();
    size_t lidar = 0;
    for (const auto& view : data.views) {
      for (const LidarSensorView& l : view->lidar) receive(*view, l, lidar++, data);
    }
    require_data(lidar > 0, "front_end: the SensorView has no lidar_sensor_view");
    ++cycle_;
  }
  void reset() override {
    cycle_ = 0;
    last_.clear();
  }
  std::unique_ptr<Strategy> clone() const override { return std::make_unique<FrontEnd>(*this); }

 private:
  // What is known of a lidar's rays.
  struct Rays {
    std::shared_ptr<const LidarConfiguration> configuration;
    std::shared_ptr<const std::vector<Vec3>> beams;  ///< Directions.
    size_t per_beam = 1;
  };

  const Rays& rays_of(const LidarSensorView& l, size_t lidar);
  size_t rays_per_beam(const LidarConfiguration& c) const;
  void receive(const SensorView& view, const LidarSensorView& l, size_t lidar, SensorData& data);
  void receive_beams(const Rays& rays, const LidarSensorView& l, uint64_t key, size_t begin,
                     size_t end, std::vector<LidarDetection>& out) const;
  LidarDetection detection_of(const Echo& echo, const Vec3& direction) const;

  FrontEndOptions options_;
  std::shared_ptr<const Profile> profile_;  ///< Null without a sensor.
  std::shared_ptr<const radiometry::Receiver> receiver_;
  std::vector<Rays> last_;  ///< The rays of each lidar; simulators may send them once only.
  uint64_t cycle_ = 0;
};

size_t FrontEnd::rays_per_beam(const LidarConfiguration& c) const {
  if (options_.rays_per_beam > 0) return options_.rays_per_beam;
  const size_t rays = c.directions.size();
  if (c.beams && *c.beams > 0) {
    require_data(rays % *c.beams == 0,
                 "front_end: the number of rays is no multiple of the pixels");
    return rays / *c.beams;
  }
  const bool is_profile = profile_ && rays == profile_->configuration.directions.size();
  return is_profile ? profile_->weight.size() : 1;
}

const FrontEnd::Rays& FrontEnd::rays_of(const LidarSensorView& l, size_t lidar) {
  if (last_.size() <= lidar) last_.resize(lidar + 1);
  Rays& rays = last_[lidar];
  const LidarConfiguration* given = l.configuration ? &*l.configuration : nullptr;
  std::shared_ptr<LidarConfiguration> next;
  if (given && !given->directions.empty()) {
    if (rays.configuration && rays.configuration->directions == given->directions) {
      next = std::make_shared<LidarConfiguration>(*given);
      rays.configuration = next;  // The beams are the same.
      return rays;
    }
    next = std::make_shared<LidarConfiguration>(*given);
  } else if (rays.configuration) {
    return rays;
  } else {
    require_data(profile_ != nullptr,
                 "front_end: the directions of the rays are in neither the view nor a sensor file");
    next = std::make_shared<LidarConfiguration>(profile_->configuration);
    if (given) next->mounting = given->mounting;
    if (given) next->sensor_id = given->sensor_id;
  }
  const size_t per_beam = rays_per_beam(*next);
  require_data(per_beam > 0 && next->directions.size() % per_beam == 0,
               "front_end: the number of rays is no multiple of the rays of a beam");
  rays.per_beam = per_beam;
  rays.beams = std::make_shared<const std::vector<Vec3>>(beam_directions(*next, per_beam));
  rays.configuration = std::move(next);
  return rays;
}

LidarDetection FrontEnd::detection_of(const Echo& echo, const Vec3& direction) const {
  LidarDetection d;
  d.distance_m = double(echo.range_m);
  d.azimuth_rad = std::atan2(direction.y(), direction.x());
  d.elevation_rad = std::atan2(direction.z(), std::hypot(direction.x(), direction.y()));
  d.intensity_percent = std::clamp(options_.percent * double(echo.intensity), 0.0, 100.0);
  if (options_.intensity == sensor::Intensity::kReflectance) {
    d.reflectivity = options_.percent * double(echo.intensity) / 100;
  }
  d.pulse_width_m = double(echo.width_m);
  return d;
}

void FrontEnd::receive_beams(const Rays& rays, const LidarSensorView& l, uint64_t key, size_t begin,
                             size_t end, std::vector<LidarDetection>& out) const {
  constexpr double kLn10By10 = 0.23025850929940458;
  const auto& c = *rays.configuration;
  const bool has_weights = profile_ && profile_->weight.size() == rays.per_beam;
  const double signal_1m =
      options_.receiver.signal_at_1m * std::exp(options_.reference_db * kLn10By10);
  const double same_m = receiver_->response().area_m();
  radiometry::Waveform scratch = receiver_->scratch();
  std::vector<float> range, signal;
  std::vector<uint32_t> from;
  for (size_t b = begin; b < end; ++b) {
    range.clear();
    signal.clear();
    from.clear();
    for (size_t k = 0; k < rays.per_beam; ++k) {
      const Reflection& f = l.reflections[b * rays.per_beam + k];
      if (f.is_miss()) continue;
      const double weight = has_weights ? double(profile_->weight[k]) : 1 / double(rays.per_beam);
      range.push_back(float(f.time_of_flight_s * radiometry::kSpeedOfLight / 2));
      signal.push_back(float(signal_1m * weight * std::exp(f.signal_db * kLn10By10)));
      from.push_back(uint32_t(b * rays.per_beam + k));
    }
    const Echoes echoes =
        receiver_->receive(range, signal, beam_key(options_.seed, key, b), scratch);
    for (const Echo& e : echoes) {
      LidarDetection d = detection_of(e, (*rays.beams)[b]);
      d.beam_id = b;
      const auto off = [&](float r) { return std::abs(r - e.range_m); };
      const auto best = std::min_element(range.begin(), range.end(),
                                         [&](float x, float y) { return off(x) < off(y); });
      if (best != range.end() && double(off(*best)) <= same_m) {
        const Reflection& f = l.reflections[from[size_t(best - range.begin())]];
        if (f.has_doppler && c.emitter_frequency_hz && *c.emitter_frequency_hz > 0) {
          d.radial_velocity_m_s =
              f.doppler_shift_hz * radiometry::kSpeedOfLight / (2 * *c.emitter_frequency_hz);
        }
      }
      out.push_back(d);
    }
  }
}

void FrontEnd::receive(const SensorView& view, const LidarSensorView& l, size_t lidar,
                       SensorData& data) {
  const Rays& rays = rays_of(l, lidar);
  const size_t count = rays.configuration->directions.size();
  if (l.reflections.size() != count) {
    throw DataError("front_end: lidar_sensor_view[" + std::to_string(lidar) + "] has " +
                    std::to_string(l.reflections.size()) + " reflections for " +
                    std::to_string(count) + " rays");
  }
  const Timestamp t = view.timestamp.value_or(Timestamp{});
  const uint64_t key = mix64(uint64_t(t.seconds) * 1'000'000'000 + t.nanos) + lidar;
  const size_t beams = rays.beams->size();
  std::vector<std::vector<LidarDetection>> blocks((beams + kBeamsABlock - 1) / kBeamsABlock);
  parallel_for(beams, kBeamsABlock, [&](size_t begin, size_t end) {
    receive_beams(rays, l, key, begin, end, blocks[begin / kBeamsABlock]);
  });
  LidarDetectionData& out = data.lidar.emplace_back();
  size_t all = 0;
  for (const auto& block : blocks) all += block.size();
  out.detections.reserve(all);
  for (const auto& block : blocks) {
    out.detections.insert(out.detections.end(), block.begin(), block.end());
  }
  out.header.measurement_time = view.timestamp;
  out.header.cycle_counter = cycle_;
  out.header.mounting = rays.configuration->mounting;
  if (!out.header.mounting) out.header.mounting = view.mounting;
  out.header.qualifier = DataQualifier::kAvailable;
  out.header.valid_detections = uint32_t(all);
  out.header.sensor_id = rays.configuration->sensor_id;
  if (!out.header.sensor_id) out.header.sensor_id = view.sensor_id.value_or(0);
}

}  // namespace

std::unique_ptr<Strategy> make_front_end(Parameters& p) {
  const std::string name = p.text("sensor", "");
  const int columns = int(p.count("columns", 0, 1024)), rows = int(p.count("rows", 0, 1024));
  std::shared_ptr<Profile> profile;
  if (!name.empty()) {
    try {
      profile = std::make_shared<Profile>(make_profile(name, columns, rows));
    } catch (const std::invalid_argument& e) {
      p.fail("sensor", e.what());
    }
  }
  const sensor::Sensor sensor = profile ? profile->sensor : sensor::Sensor{};
  FrontEndOptions o;
  o.receiver = radiometry::receiver_options(sensor);
  o.receiver.max_range_m = p.number("max_range_m", o.receiver.max_range_m, 1, 100000);
  o.receiver.noise_sigma = p.number("noise", o.receiver.noise_sigma, 0, 1000);
  o.receiver.detector.threshold =
      float(p.number("threshold_snr", double(o.receiver.detector.threshold), 1e-6, 1e9));
  const auto most = int(p.count("max_echoes", 0, Echoes::kMost));
  if (most > 0) {
    o.receiver.max_echoes = most;
    o.receiver.mode = most > 1 ? sensor::ReturnMode::kAll : sensor::ReturnMode::kStrongest;
  }
  o.reference_db = p.number("reference_db", 0, -500, 500);
  o.rays_per_beam = p.count("rays_per_beam", 0, 1 << 20);
  o.seed = p.count("seed", 1, uint64_t(1) << 53);
  o.intensity = o.receiver.intensity;
  o.percent =
      100 / (o.intensity == sensor::Intensity::kSignal && std::isfinite(o.receiver.intensity_most)
                 ? o.receiver.intensity_most
                 : o.receiver.intensity_scale);
  return std::make_unique<FrontEnd>(o, profile);
}

}  // namespace underbrush::osi
