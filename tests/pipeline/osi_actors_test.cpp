// Actors as the ground truth of traces, and traces that are replayed with actors.
#include <gtest/gtest.h>

#include <map>

#include "data.hpp"
#include "io/temporary.hpp"
#include "underbrush/actors/actor.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/write.hpp"
#include "underbrush/pipeline/osi_trace.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::pipeline {
namespace {

constexpr const char* kGiven = "osi/qc_example_sv_trace.osi";

/// A closed box about the origin.
elements::Model box(const Vec3& size) {
  elements::Model m;
  m.fitter = "mesh";
  for (int k = 0; k < 8; ++k) {
    const Vec3f corner(k & 1 ? 0.5F : -0.5F, k & 2 ? 0.5F : -0.5F, k & 4 ? 0.5F : -0.5F);
    m.surface.vertices.emplace_back(corner.cwiseProduct(size.cast<float>()));
  }
  m.surface.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                         {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  m.surface.hit.resize(12);
  return m;
}

actors::Actor actor(const std::string& name, const std::string& label, elements::Model model,
                    const Pose& from = {}, const Vec3& velocity = Vec3::Zero()) {
  Pose to = from;
  to.translation += velocity;
  return {name, label, std::move(model), Trajectory({{0, from}, {1, to}})};
}

class OsiActors : public testing::Test {
 protected:
  /// The first messages of the given trace, whose moving objects are named after their numbers, and
  /// those objects.
  std::vector<osi::MovingObject> name_objects() {
    constexpr int kMessages = 5;
    osi::TraceReader reader(test::data_folder() / kGiven);
    osi::TraceWriter writer(trace_);
    std::vector<osi::MovingObject> found;
    std::string bytes;
    for (int k = 0; k < kMessages && reader.next(bytes); ++k) {
      osi::SensorView view = osi::read_sensor_view(bytes, reader.place());
      for (osi::MovingObject& m : view.truth->moving) {
        m.model_reference = "actor-" + std::to_string(m.id);
      }
      if (k == 0) found = view.truth->moving;
      bytes.clear();
      osi::write(view, bytes);
      writer.write(bytes);
    }
    writer.close();
    return found;
  }
  /// For each object of the first message, the returns that the replay with actors has from it.
  std::map<uint64_t, size_t> returns(const std::string& actors) {
    osi::OsiOptions options;
    options.replay.strategies = {"tracer:sensor=velodyne-vlp16,z_m=1.8,columns=1,rows=1"};
    options.replay.actors = actors;
    replay_trace(trace_, folder_ / "data.osi", options, "{}");
    osi::TraceReader reader(folder_ / "data.osi");
    reader.next(last_);
    const osi::SensorData data = osi::read_sensor_data(last_, "data");
    std::map<uint64_t, size_t> out;
    for (const osi::Reflection& f : data.views.at(0)->lidar.at(0).reflections) {
      if (!f.is_miss()) ++out[f.object_id];
    }
    return out;
  }

  io::TemporaryFolder folder_;
  std::filesystem::path trace_ = folder_ / "given_sv_.osi";
  std::string last_;  ///< The bytes of the last replay's first message.
};

TEST_F(OsiActors, AreFoundByNameOrClassInAGivenTrace) {
  UNDERBRUSH_NEEDS_DATA(kGiven);
  const std::vector<osi::MovingObject> objects = name_objects();
  std::vector<actors::Actor> whole, half, of_class;
  for (const osi::MovingObject& m : objects) {
    const Vec3 size = *m.base.dimension_m;
    whole.push_back(actor(m.model_reference, "unknown", box(size)));
    half.push_back(actor(m.model_reference, "unknown", box(size / 2)));
  }
  of_class.push_back(actor("another", "car", box({0.5, 0.5, 0.5})));
  const std::map<uint64_t, size_t> plain = returns("");
  const std::string as_boxes = last_;
  actors::write_actors(folder_ / "whole", whole, "{}");
  EXPECT_EQ(returns((folder_ / "whole").string()), plain);
  EXPECT_EQ(last_, as_boxes) << "an actor that is a box is that box, to the bit";
  for (const auto& [name, list] : {std::pair{"half", &half}, std::pair{"of_class", &of_class}}) {
    actors::write_actors(folder_ / name, *list, "{}");
    const std::map<uint64_t, size_t> fewer = returns((folder_ / name).string());
    size_t seen = 0;
    for (const auto& [id, n] : plain) {
      if (id == osi::kNoId || n < 4) continue;
      ++seen;
      const auto found = fewer.find(id);
      EXPECT_LT(found == fewer.end() ? 0 : found->second, n) << name << " " << id;
    }
    EXPECT_GT(seen, 0u);
  }
}

TEST_F(OsiActors, AreTheTruthOfARecordedLog) {
  const Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3::UnitZ())), Vec3(10, 2, 0.7)};
  std::vector<actors::Actor> list{
      actor("van-7", "van", box({5, 2, 2.2}), turned, {8, 0, 0}),
      actor("walker", "pedestrian", box({0.5, 0.5, 1.8}), {}, {1, 0, 0})};
  list[1].from_s = 0.35;
  actors::write_actors(folder_ / "actors", list, "{}");
  const Trajectory path({{0, Pose()}, {1, Pose()}});
  io::write_log(folder_ / "log.ply", sensor::beams(sensor::load("velodyne-vlp16"), path, 0, 0.5),
                "{}");
  osi::OsiOptions options;
  options.truth = (folder_ / "actors").string();
  const osi::RecordCounts n = record_trace(folder_ / "log.ply", trace_, options, "{}");
  EXPECT_EQ(n.views, 5u);
  EXPECT_EQ(n.objects, 5u + 1u);
  osi::TraceReader reader(trace_);
  std::string bytes;
  for (int k = 0; reader.next(bytes); ++k) {
    const osi::SensorView view = osi::read_sensor_view(bytes, reader.place());
    const osi::MovingObject& van = view.truth->moving.at(1);  // The host is first.
    EXPECT_EQ(van.model_reference, "van-7");
    const Vec3 expected = turned.translation + Vec3(8 * view.timestamp->s(), 0, 0);
    EXPECT_LT((*van.base.position_m - expected).norm(), 1e-6);
    EXPECT_NEAR(van.base.roll_pitch_yaw->z(), 0.3, 1e-9);
    EXPECT_LT((*van.base.dimension_m - Vec3(5, 2, 2.2)).norm(), 1e-5);
    EXPECT_EQ(view.truth->moving.size(), k < 4 ? 2u : 3u) << "the walker comes later";
  }
}

}  // namespace
}  // namespace underbrush::pipeline
