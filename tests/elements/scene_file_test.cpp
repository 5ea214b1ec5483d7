#include "underbrush/elements/scene_file.hpp"

#include <gtest/gtest.h>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/model_file.hpp"

namespace underbrush::elements {
namespace {

Scene scene(SceneInfo& info) {
  Scene s;
  Stream random(1);
  for (int m = 0; m < 3; ++m) {
    s.models.emplace_back();
    s.models.back().fitter = "test";
    for (int k = 0; k <= m; ++k) {
      s.models.back().ellipsoids.emplace_back();
      s.models.back().ellipsoids.back().mean = Vec3f(float(m), float(k), 0);
    }
    info.names.push_back("model " + std::to_string(m));
  }
  for (int k = 0; k < 500; ++k) {
    Instance i;
    for (int d = 0; d < 3; ++d) i.world_from_model.translation[d] = random.uniform(-5e6, 5e6);
    i.world_from_model.rotation =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
            .normalized();
    i.scale = float(random.uniform(0.5, 2));
    i.model = uint32_t(random.below(3));
    s.instances.push_back(i);
    info.labels.push_back(Class(random.below(kClassNames.size())));
  }
  info.provenance = R"({"seed":7})";
  return s;
}

TEST(SceneFile, ComesBackToTheBit) {
  const io::TemporaryFolder folder;
  SceneInfo info, back;
  const Scene s = scene(info);
  write_scene(folder / "scene", s, info);
  EXPECT_TRUE(is_scene(folder / "scene"));
  EXPECT_TRUE(is_model(folder / "scene/models/0002"));  // each model is readable by itself
  const Scene t = read_scene(folder / "scene", &back);
  ASSERT_EQ(t.instances.size(), s.instances.size());
  for (size_t k = 0; k < s.instances.size(); ++k) {
    EXPECT_EQ(t.instances[k].world_from_model.translation,
              s.instances[k].world_from_model.translation);
    EXPECT_EQ(t.instances[k].world_from_model.rotation.coeffs(),
              s.instances[k].world_from_model.rotation.coeffs());
    EXPECT_EQ(t.instances[k].scale, s.instances[k].scale);
    EXPECT_EQ(t.instances[k].model, s.instances[k].model);
  }
  ASSERT_EQ(t.models.size(), 3u);
  EXPECT_EQ(t.models[2].ellipsoids.size(), 3u);
  EXPECT_EQ(back.names, info.names);
  EXPECT_EQ(back.labels, info.labels);
  EXPECT_EQ(back.provenance, info.provenance);
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_TRUE(back.movers.empty());
}

TEST(SceneFile, KeepsMoversAndMaterials) {
  const io::TemporaryFolder folder;
  SceneInfo info, back;
  const Scene s = scene(info);
  info.materials = {"", "car_paint", ""};
  const Pose a{Eigen::Quaterniond(Eigen::AngleAxisd(1.0 / 3, Vec3::UnitZ())), Vec3(0.1, 5e6, -1)};
  info.movers = {{499, Trajectory({{1e9 + 1.0 / 3, a}})},
                 {7, Trajectory({{0, a}, {2, Pose{}}}), 1.0 / 3}};
  write_scene(folder / "scene", s, info);
  read_scene(folder / "scene", &back);
  EXPECT_EQ(back.materials, info.materials);
  ASSERT_EQ(back.movers.size(), 2u);
  EXPECT_EQ(back.movers[0].instance, 499u);
  EXPECT_EQ(back.movers[0].world_from_object.poses()[0].time_s, 1e9 + 1.0 / 3);
  EXPECT_EQ(back.movers[0].world_from_object.poses()[0].world_from_sensor.translation,
            a.translation);
  EXPECT_EQ(back.movers[1].world_from_object.poses().size(), 2u);
  EXPECT_EQ(back.movers[0].from_s, -HUGE_VAL);
  EXPECT_EQ(back.movers[1].from_s, 1.0 / 3);
  EXPECT_EQ(back.movers[1].to_s, HUGE_VAL);
  std::filesystem::remove(folder / "scene/movers/0001.txt");
  EXPECT_THROW(read_scene(folder / "scene"), FormatError);
}

TEST(SceneFile, ThatIsDamagedIsRefused) {
  const io::TemporaryFolder folder;
  SceneInfo info;
  Scene s = scene(info);
  EXPECT_THROW(read_scene(folder / "none"), FormatError);
  write_scene(folder / "scene", s, info);
  const std::string table = io::bytes_of(folder / "scene/instances.ply");
  const std::string manifest = io::bytes_of(folder / "scene/scene.json");
  io::put_bytes(folder / "scene/instances.ply", table.substr(0, table.size() - 9));
  EXPECT_THROW(read_scene(folder / "scene"), FormatError);
  std::string bad = table;
  bad.back() = char(200);  // the class of the last instance
  io::put_bytes(folder / "scene/instances.ply", bad);
  EXPECT_THROW(read_scene(folder / "scene"), FormatError);
  bad = table;
  bad[bad.size() - 3] = 9;  // the model of the last instance
  io::put_bytes(folder / "scene/instances.ply", bad);
  EXPECT_THROW(read_scene(folder / "scene"), FormatError);
  io::put_bytes(folder / "scene/instances.ply", table);
  EXPECT_NO_THROW(read_scene(folder / "scene"));
  for (const auto& [from, to] : {std::pair{"\"version\": 1", "\"version\": 2"},
                                 {"\"count\": 500", "\"count\": 499"},
                                 {"underbrush-scene", "a-scene"}}) {
    std::string text = manifest;
    text.replace(text.find(from), std::string(from).size(), to);
    io::put_bytes(folder / "scene/scene.json", text);
    EXPECT_THROW(read_scene(folder / "scene"), FormatError) << to;
  }
  std::filesystem::remove_all(folder / "scene/models/0001");
  io::put_bytes(folder / "scene/scene.json", manifest);
  EXPECT_THROW(read_scene(folder / "scene"), FormatError);
}

TEST(SceneFile, DoesNotReplaceOthersFolders) {
  const io::TemporaryFolder folder;
  SceneInfo info;
  const Scene s = scene(info);
  io::put_bytes(folder / "mine/thesis.tex", "years");
  EXPECT_THROW(write_scene(folder / "mine", s, info), IoError);
  info.labels.pop_back();
  EXPECT_THROW(write_scene(folder / "scene", s, info), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::elements
