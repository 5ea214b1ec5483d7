// The strategy `tracer`, which traces the rays of the FMU, meets the matter that `simulate` meets
// at the same time, also where the matter sways.
#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/osi/chain.hpp"
#include "underbrush/osi/profile.hpp"
#include "underbrush/pipeline/simulation.hpp"
#include "underbrush/radiometry/response.hpp"

namespace underbrush::pipeline {
namespace {

constexpr const char* kSensor =
    "name: few\nkind: raster\nshots_per_s: 40000\nraster:\n  azimuth_deg: [-30, 30]\n"
    "  elevation_deg: [-4, 4]\n  step_deg: [0.5, 0.5]\nmin_range_m: 0.5\nmax_range_m: 100\n"
    "divergence_mrad: [2, 2]\nprofile: uniform\nsub_rays: [1, 1]\n";

/// Leaves, some of whose beams pass, before a wall.
elements::Model leaves(double sway_s) {
  elements::Model model;
  model.tau = 3;
  model.grain.ellipsoid_m = model.grain.mesh_m = 0.1;
  model.sway_s = sway_s;
  model.range_noise_m = 0;  // What is drawn is the matter alone.
  elements::Ellipsoid e;
  e.mean = Vec3f(20, 0, 0);
  e.set_covariance(Vec3(0.09, 400, 400).asDiagonal());
  e.hit.p = 0.6F;
  model.ellipsoids.push_back(e);
  model.surface.vertices = {{40, -90, -90}, {40, 90, -90}, {40, 0, 90}};
  model.surface.triangles = {{0, 1, 2}};
  model.surface.hit.resize(1);
  model.surface.hit[0].p = 1;
  model.surface.range_sigma_m = 0;
  return model;
}

osi::SensorView view_at(double time_s) {
  osi::SensorView v;
  v.version = osi::Version{};
  v.timestamp = osi::Timestamp::of(time_s);
  v.sensor_id = 1;
  v.host_vehicle_id = 1;
  osi::MovingObject host;
  host.id = 1;
  host.type = uint32_t(osi::ObjectType::kVehicle);
  host.base.position_m = Vec3(0.5, -1, 0.25);
  host.base.dimension_m = Vec3(4.6, 1.8, 1.5);
  v.truth.emplace();
  v.truth->timestamp = v.timestamp;
  v.truth->moving = {host};
  return v;
}

class OsiMatter : public testing::Test {
 protected:
  OsiMatter() { write_file(folder_ / "few.yaml", kSensor); }

  std::vector<float> of_tracer(const elements::Model& model, double time_s) {
    const std::string world = (folder_ / "world").string();
    elements::write_model(world, model);
    osi::ChainFile file;
    file.strategies.push_back({"tracer", "", {}, "test", "tracer"});
    file.set("tracer", "sensor", (folder_ / "few.yaml").string());
    file.set("tracer", "world", world);
    osi::Chain chain(file);
    const osi::SensorData data =
        chain.step(std::make_shared<const osi::SensorView>(view_at(time_s)));
    std::vector<float> ranges;
    for (const osi::Reflection& f : data.views.at(0)->lidar.at(0).reflections) {
      // Logs have ranges in single precision.
      ranges.push_back(f.is_miss() ? kMiss
                                   : float(f.time_of_flight_s * radiometry::kSpeedOfLight / 2));
    }
    return ranges;
  }

  std::vector<float> of_simulate(const elements::Model& model, double time_s) {
    const osi::Profile profile = osi::make_profile((folder_ / "few.yaml").string(), 1, 1);
    const osi::SensorView view = view_at(time_s);
    BeamLog beams;
    beams.info.max_range_m = 100;
    beams.resize(profile.configuration.directions.size());
    for (size_t i = 0; i < beams.size(); ++i) {
      beams.origin[i] = *view.host()->base.position_m;
      beams.direction[i] = profile.configuration.directions[i];
      beams.time_s[i] = view.timestamp->s();
    }
    const TracedWorld world(model);
    Simulation(world, {}).answer(0, beams);
    return beams.range_m;
  }

 private:
  io::TemporaryFolder folder_;
};

size_t other(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  size_t n = 0;
  for (size_t i = 0; i < a.size(); ++i) n += a[i] != b[i];
  return n;
}

TEST_F(OsiMatter, TheTracerAnswersAsSimulateDoesAtTheSameTime) {
  for (const double sway_s : {0.0, 0.5}) {
    const elements::Model model = leaves(sway_s);
    for (const double time_s : {0.1, 0.35, 7.0}) {
      const auto ours = of_simulate(model, time_s);
      ASSERT_GT(ours.size(), 2000u);
      EXPECT_EQ(other(of_tracer(model, time_s), ours), 0u) << sway_s << ' ' << time_s;
    }
    const size_t moved = other(of_tracer(model, 0.1), of_tracer(model, 7.0));
    EXPECT_EQ(moved > 500, sway_s > 0) << moved;
  }
}

}  // namespace
}  // namespace underbrush::pipeline
