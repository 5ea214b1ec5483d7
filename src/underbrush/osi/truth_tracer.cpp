#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/osi/mover_models.hpp"
#include "underbrush/osi/objects.hpp"
#include "underbrush/osi/profile.hpp"
#include "underbrush/osi/strategies.hpp"
#include "underbrush/osi/traced_part.hpp"
#include "underbrush/osi/write.hpp"
#include "underbrush/radiometry/response.hpp"

namespace underbrush::osi {
namespace fs = std::filesystem;
namespace {

constexpr size_t kRaysABlock = 8192;
constexpr float kGroundHalfM = 2000;
constexpr uint32_t kStatic = 1u << 30;  // Numbers of the static world's instances begin here.

struct TracerOptions {
  std::string world, mover_models, mover_material = "car_paint", ground_material = "asphalt";
  bool has_ground = true, writes_rays = true, is_mounted = false;
  std::optional<double> ground_z_m;
  double extinction_per_m = 0;
  Pose vehicle_from_lidar;
  uint64_t sensor_id = 0, seed = 1;
};

elements::Model ground_model() {
  const float h = kGroundHalfM, z = 0;
  return mesh_model({{-h, -h, z}, {h, -h, z}, {h, h, z}, {-h, h, z}}, {{0, 1, 2}, {0, 2, 3}});
}

/// The height of the ground (m, world): the given one, or else the lowest side of the boxes of the
/// host and of what moves near it.
double ground_z_m(const TracerOptions& o, const SensorView& view) {
  constexpr double kNearM = 50;
  if (o.ground_z_m) return *o.ground_z_m;
  const MovingObject* host = view.host();
  if (!host || !host->base.position_m) return 0;
  std::optional<double> lowest;
  for (const MovingObject& m : view.truth->moving) {
    if (!m.base.position_m || !m.base.dimension_m || m.base.dimension_m->minCoeff() <= 0) continue;
    if ((*m.base.position_m - *host->base.position_m).norm() > kNearM) continue;
    const double side = m.base.position_m->z() - m.base.dimension_m->z() / 2;
    lowest = std::min(side, lowest.value_or(side));
  }
  return lowest.value_or(0);
}

/// What does not change from cycle to cycle.
struct TracerWorld {
  TracerOptions options;
  Profile profile;
  radiometry::Materials materials;
  MoverModels movers;
  std::vector<std::shared_ptr<const TracedPart>> parts;  ///< The world, if there is one.

  double wavelength_m() const {
    return profile.sensor.wavelength_m > 0 ? profile.sensor.wavelength_m : 905e-9;
  }
};

/// Answers the rays of a lidar by ray tracing, and adds the reflections to the SensorView.
class TruthTracer : public Strategy {
 public:
  explicit TruthTracer(std::shared_ptr<const TracerWorld> world) : world_(std::move(world)) {}

  void step(SensorData& data) override {
    require_data(!data.views.empty() && data.views[0]->truth && data.host,
                 "tracer: there is no SensorView with a ground truth and a host vehicle");
    auto view = std::make_shared<SensorView>(*data.views[0]);
    LidarSensorView lidar = traced(*view, *data.host);
    if (!view->bytes.empty()) write_lidar_views({&lidar, 1}, view->bytes);
    view->lidar.push_back(std::move(lidar));
    data.views[0] = std::move(view);
  }
  void reset() override {}
  std::unique_ptr<Strategy> clone() const override { return std::make_unique<TruthTracer>(*this); }

 private:
  LidarSensorView traced(const SensorView& view, const BaseMoving& host) const;
  void check_height(const SensorView& view, const Pose& host, const Pose& lidar) const;
  std::unique_ptr<TracedPart> placed_movers(const SensorView& view,
                                            std::vector<uint64_t>& ids) const;

  std::shared_ptr<const TracerWorld> world_;
};

std::unique_ptr<TracedPart> TruthTracer::placed_movers(const SensorView& view,
                                                       std::vector<uint64_t>& ids) const {
  elements::Scene scene;
  elements::SceneInfo info;
  const MovingObject* host = view.host();
  const double time_s = view.timestamp.value_or(Timestamp{}).s();
  for (const MovingObject& m : view.truth->moving) {
    if (&m == host || !m.base.position_m || !m.base.dimension_m) continue;
    if (m.base.dimension_m->minCoeff() <= 0) continue;
    elements::Instance placed;
    placed.model = uint32_t(scene.models.size());
    placed.world_from_model = m.base.pose();
    scene.models.push_back(world_->movers.model(m, time_s));
    scene.instances.push_back(placed);
    info.materials.push_back(world_->options.mover_material);
    info.labels.push_back(elements::Class::kUnknown);
    ids.push_back(m.id);
  }
  if (world_->options.has_ground) {  // It lies below the vehicle, however far that has driven.
    elements::Instance ground;
    ground.model = uint32_t(scene.models.size());
    ground.world_from_model.translation = Vec3(host ? host->base.pose().translation : Vec3::Zero());
    ground.world_from_model.translation.z() = ground_z_m(world_->options, view);
    scene.models.push_back(ground_model());
    scene.instances.push_back(ground);
    info.materials.push_back(world_->options.ground_material);
    info.labels.push_back(elements::Class::kUnknown);
    ids.push_back(kNoId);
  }
  if (scene.instances.empty()) return nullptr;
  return std::make_unique<TracedPart>(std::move(scene), std::move(info), world_->materials,
                                      world_->wavelength_m());
}

// A lidar below the ground would see the ground from below, and nothing else.
void TruthTracer::check_height(const SensorView& view, const Pose& host, const Pose& lidar) const {
  if (!world_->options.has_ground) return;
  const double ground_m = ground_z_m(world_->options, view);
  if (lidar.translation.z() > ground_m) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "tracer: the lidar is %.2f m below the ground: the vehicle's origin is at a height "
                "of %.2f m, the lidar %.2f m above it (z_m), and the ground at %.2f m (ground_z_m)",
                ground_m - lidar.translation.z(), host.translation.z(),
                lidar.translation.z() - host.translation.z(), ground_m);
  throw DataError(text);
}

LidarSensorView TruthTracer::traced(const SensorView& view, const BaseMoving& host) const {
  const TracerOptions& o = world_->options;
  const Profile& profile = world_->profile;
  LidarSensorView out;
  LidarConfiguration& c = out.configuration.emplace();
  if (o.writes_rays) {
    c = profile.configuration;
  } else {
    c.beams = profile.configuration.beams;
    c.emitter_frequency_hz = profile.configuration.emitter_frequency_hz;
  }
  c.sensor_id = o.sensor_id;
  c.mounting = o.is_mounted || !view.mounting ? Mounting::of(o.vehicle_from_lidar) : *view.mounting;
  const Pose world_from_lidar = host.pose() * c.mounting->pose();
  check_height(view, host.pose(), world_from_lidar);
  std::vector<uint64_t> ids;
  const auto movers = placed_movers(view, ids);
  const auto& directions = profile.configuration.directions;
  const double time_s = view.timestamp.value_or(Timestamp{}).s();
  const Timestamp t = view.timestamp.value_or(Timestamp{});
  const uint64_t scan = mix64(uint64_t(t.seconds) * 1'000'000'000 + t.nanos) + o.sensor_id;
  const trace::RangeLimits limits{std::max(profile.sensor.min_range_m, kLeastRangeM),
                                  profile.sensor.max_range_m};
  out.reflections.resize(directions.size());
  parallel_for(directions.size(), kRaysABlock, [&](size_t begin, size_t end) {
    std::vector<Ray> rays(end - begin);
    std::vector<uint64_t> keys(end - begin);
    std::vector<Meeting> met(end - begin);
    for (size_t i = begin; i < end; ++i) {
      rays[i - begin] = {world_from_lidar.translation,
                         (world_from_lidar.rotation * directions[i].cast<double>()).normalized()};
      keys[i - begin] = beam_key(o.seed, scan, i);
    }
    for (const auto& part : world_->parts) {
      part->trace(rays, keys, o.seed, time_s, limits, kStatic, met);
    }
    if (movers) movers->trace(rays, keys, o.seed, time_s, limits, 0, met);
    for (size_t i = begin; i < end; ++i) {
      const Meeting& m = met[i - begin];
      if (m.range_m <= 0 || m.factor <= 0) continue;
      Reflection& f = out.reflections[i];
      const double loss = std::exp(-2 * o.extinction_per_m * m.range_m);
      f.signal_db = 10 * std::log10(m.factor * loss / (m.range_m * m.range_m));
      f.time_of_flight_s = 2 * m.range_m / radiometry::kSpeedOfLight;
      if (m.instance < kStatic) f.object_id = ids[m.instance];
    }
  });
  return out;
}

elements::Scene read_world(const std::string& folder, elements::SceneInfo& info) {
  if (elements::is_scene(folder)) {
    elements::Scene scene = elements::read_scene(folder, &info);
    require_data(info.movers.empty(), "tracer: the world has movers of its own");
    return scene;
  }
  elements::Scene scene;
  scene.models.push_back(elements::read_model(folder));
  info.class_names = scene.models[0].class_names;
  return scene;
}

void add_parts(TracerWorld& w) {
  const TracerOptions& o = w.options;
  if (!o.world.empty()) {
    elements::SceneInfo info;
    elements::Scene scene = read_world(o.world, info);
    w.parts.push_back(std::make_shared<TracedPart>(std::move(scene), std::move(info), w.materials,
                                                   w.wavelength_m()));
  }
}

Pose mounting_of(Parameters& p) {
  constexpr double kFar = 1000;
  const double x = p.number("x_m", 0, -kFar, kFar), y = p.number("y_m", 0, -kFar, kFar);
  const double z = p.number("z_m", 0, -kFar, kFar);
  const double roll = p.number("roll_deg", 0, -360, 360),
               pitch = p.number("pitch_deg", 0, -360, 360);
  const double yaw = p.number("yaw_deg", 0, -360, 360);
  return {rotation_of(Vec3(roll, pitch, yaw) * kDegree), {x, y, z}};
}

}  // namespace

std::unique_ptr<Strategy> make_tracer(Parameters& p) {
  auto world = std::make_shared<TracerWorld>(TracerWorld{{}, {}, {}, MoverModels(""), {}});
  TracerOptions& o = world->options;
  const std::string sensor = p.text("sensor", kTracedSensor);
  const auto columns = int(p.count("columns", 0, 1024)), rows = int(p.count("rows", 0, 1024));
  o.world = p.text("world", "");
  o.mover_models = p.text("mover_models", "");
  o.mover_material = p.text("mover_material", "car_paint");
  o.ground_material = p.text("ground_material", "asphalt");
  o.has_ground = p.flag("ground", o.world.empty());
  o.writes_rays = p.flag("write_rays", true);
  const double ground_m = p.number("ground_z_m", NAN, -10000, 10000);
  if (!std::isnan(ground_m)) o.ground_z_m = ground_m;
  o.extinction_per_m = p.number("extinction_per_m", 0, 0, 1);
  o.vehicle_from_lidar = mounting_of(p);
  o.is_mounted = p.flag("mounted", true);
  o.sensor_id = p.count("sensor_id", 0, uint64_t(1) << 53);
  o.seed = p.count("seed", 1, uint64_t(1) << 53);
  p.finish();
  try {
    world->profile = make_profile(sensor, columns, rows);
    world->materials = radiometry::load_materials();
    world->movers = MoverModels(o.mover_models);
    add_parts(*world);
  } catch (const std::invalid_argument& e) {
    p.fail("", e.what());
  } catch (const fs::filesystem_error&) {
    p.fail("mover_models", "is no folder");
  }
  return std::make_unique<TruthTracer>(std::move(world));
}

}  // namespace underbrush::osi
