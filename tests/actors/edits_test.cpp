// Edits of actors, and the files that list them.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "io/temporary.hpp"
#include "underbrush/actors/actor_edits.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/pipeline/simulation.hpp"

namespace underbrush::actors {
namespace {

using Json = nlohmann::json;

Pose at(double x, double y = 0, double yaw = 0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), Vec3(x, y, 0)};
}

/// A wall of 2 m by 2 m across x at zero.
elements::Model sheet() {
  elements::Model m;
  m.fitter = "test";
  m.surface.vertices = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
  m.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  m.surface.hit.resize(2);
  return m;
}

/// A van that drives from x = 10 at 10 m/s for 2 s, and a walker in two parts.
std::vector<Actor> some_actors() {
  const Trajectory drive({{0, at(10)}, {2, at(30)}}), walk({{0, at(5, 5)}, {2, at(5, 7)}});
  return {{"van-1", "van", sheet(), drive, 0, 2},
          {"pedestrian-2", "pedestrian", sheet(), walk, 0, 1},
          {"pedestrian-2", "pedestrian", sheet(), walk, 1, 2}};
}

double x_at(const Actor& a, double t) { return a.world_from_actor.at(t)->translation.x(); }

TEST(ActorEdits, AreWhatTheirNamesSay) {
  std::vector<Actor> actors = some_actors();
  move_actor(actors, "van-1", {Eigen::Quaterniond(0, 0, 0, 1), Vec3(3, 0, 0)});
  EXPECT_NEAR(x_at(actors[0], 1), 23, 1e-12);
  EXPECT_NEAR((actors[0].world_from_actor.at(1)->rotation * Vec3::UnitX()).x(), -1, 1e-12);
  move_actor(actors, "van-1", at(3));  // backwards now
  EXPECT_NEAR(x_at(actors[0], 1), 20, 1e-12);
  delay_actor(actors, "van-1", 0.5);
  EXPECT_NEAR(x_at(actors[0], 1), 15, 1e-12);
  EXPECT_EQ(actors[0].from_s, 0.5);
  EXPECT_EQ(actors[0].to_s, 2.5);
  copy_actor(actors, "pedestrian-2", "twin");
  ASSERT_EQ(actors.size(), 5u);
  remove_actor(actors, "pedestrian-2");
  ASSERT_EQ(actors.size(), 3u);
  EXPECT_EQ(actors[2].name, "twin");
  EXPECT_EQ(actors[2].from_s, 1);
  replace_model(actors, "twin", sheet());
  ASSERT_EQ(actors.size(), 2u);
  EXPECT_EQ(actors[1].from_s, 0);
  EXPECT_EQ(actors[1].to_s, 2);
  redirect_actor(actors, "van-1", Trajectory({{4, at(1)}, {6, at(2)}}));
  EXPECT_EQ(actors[0].from_s, 4);
  EXPECT_EQ(actors[0].to_s, 6);
  EXPECT_THROW(remove_actor(actors, "nobody"), std::invalid_argument);
  EXPECT_THROW(copy_actor(actors, "twin", "van-1"), std::invalid_argument);
}

TEST(Actors, AreMetWhereAndWhileTheyAreThere) {
  const io::TemporaryFolder folder;
  write_actors(folder / "actors", some_actors(), "");
  pipeline::World world;
  world.scene.models.push_back(sheet());
  for (Vec3f& v : world.scene.models[0].surface.vertices) v = 100 * v + Vec3f(50, 0, 0);
  pipeline::add_actors(world, read_actors(folder / "actors"));
  EXPECT_EQ(elements::class_name(world.info, world.info.labels.at(1)), "van");
  const pipeline::TracedWorld traced(std::move(world));
  BeamLog beams;
  beams.info.max_range_m = 120;
  beams.resize(31);
  for (size_t i = 0; i < beams.size(); ++i) beams.time_s[i] = 0.1 * double(i);
  pipeline::Simulation(traced, {}).answer(0, beams);
  for (size_t i = 0; i < beams.size(); ++i) {
    EXPECT_NEAR(beams.range_m[i], i < 20 ? 10 + double(i) : 50, 1e-4) << i;
  }
}

TEST(ActorEdits, AShiftFadesAwayFromItsTime) {
  std::vector<StampedPose> poses;
  for (int k = 0; k <= 20; ++k) poses.push_back({0.1 * k, at(k, 0, 0.7)});
  const std::vector<Actor> before{{"van-1", "van", sheet(), Trajectory(poses)}};
  std::vector<Actor> whole = before, bent = before;
  shift_actor(whole, "van-1", Vec3(0, 2, 1), 0, std::numeric_limits<double>::infinity());
  shift_actor(bent, "van-1", Vec3(0, 2, 1), 0.8, 0.6);
  for (int k = 0; k <= 20; ++k) {
    const auto moved = [&](const std::vector<Actor>& by) {
      const Pose now = by[0].world_from_actor.poses()[size_t(k)].world_from_sensor;
      EXPECT_EQ(now.rotation.coeffs(), poses[size_t(k)].world_from_sensor.rotation.coeffs());
      return Vec3(now.translation - poses[size_t(k)].world_from_sensor.translation);
    };
    EXPECT_LT((moved(whole) - Vec3(0, 2, 1)).norm(), 1e-12) << k;
    const double share = k == 8 ? 1 : k == 5 || k == 11 ? 0.5 : k > 2 && k < 14 ? -1 : 0;
    if (share >= 0) {
      EXPECT_LT((moved(bent) - share * Vec3(0, 2, 1)).norm(), 1e-12) << k;
    }
  }
}

class EditFile : public testing::Test {
 protected:
  EditFile() {
    write_actors(folder_ / "actors", some_actors(), "");
    std::ofstream(folder_ / "path.txt") << "0 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n";
    std::ofstream(folder_ / "box.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::ifstream(UNDERBRUSH_TEST_SCHEMAS "/actor-edits.json") >> schema_;
  }

  std::vector<Actor> read(const Json& edits) {
    std::ofstream(folder_ / "edits.json") << Json{{"format", "underbrush-actor-edits"},
                                                  {"version", 1},
                                                  {"actors", "actors"},
                                                  {"edits", edits}};
    return read_actors(folder_ / "edits.json");
  }
  std::string said_of(const Json& edits) {
    try {
      read(edits);
      return "";
    } catch (const FormatError& e) {
      return e.what();
    }
  }

  io::TemporaryFolder folder_;
  Json schema_;
};

/// One edit of each kind, with all members that it may have.
const std::map<std::string, Json>& every_edit() {
  static const std::map<std::string, Json> kEdits{
      {"remove", {{"actor", "van-1"}}},
      {"move", {{"actor", "van-1"}, {"translation_m", {1, 0, 0}}, {"yaw_rad", 3.14}}},
      {"delay", {{"actor", "van-1"}, {"by_s", -1}}},
      {"shift", {{"actor", "van-1"}, {"translation_m", {1, 0, 0}}, {"at_s", 1}, {"within_s", 2}}},
      {"copy", {{"actor", "van-1"}, {"as", "van-2"}}},
      {"trajectory", {{"actor", "van-1"}, {"trajectory", "path.txt"}}},
      {"model", {{"actor", "pedestrian-2"}, {"model", "box.obj"}}}};
  return kEdits;
}

TEST_F(EditFile, HasTheMembersOfTheSchema) {
  EXPECT_EQ(schema_["$defs"]["edit"]["oneOf"].size(), every_edit().size());
  for (const auto& [kind, members] : every_edit()) {
    Json good = members;
    good["edit"] = kind;
    good["comment"] = "any";
    EXPECT_EQ(said_of(Json::array({good})), "") << kind;
    const Json& described = schema_["$defs"][kind];
    for (const auto& [name, member] : described["properties"].items()) {
      ASSERT_TRUE(good.contains(name)) << kind << " " << name;
      Json less = good;
      less.erase(name);
      const auto& required = described["required"];
      const bool is_needed = std::find(required.begin(), required.end(), name) != required.end() ||
                             described.value("dependentRequired", Json::object()).contains(name);
      EXPECT_EQ(said_of(Json::array({less})).empty(), !is_needed) << kind << " " << name;
    }
    EXPECT_EQ(described["properties"].size(), good.size()) << kind;
    good["unheard_of"] = 1;
    EXPECT_NE(said_of(Json::array({good})).find("unheard_of"), std::string::npos) << kind;
  }
}

TEST_F(EditFile, IsAppliedInItsOrder) {
  const auto actors = read(Json::parse(R"([
      {"edit": "copy", "actor": "van-1", "as": "second"},
      {"edit": "delay", "actor": "second", "by_s": 2},
      {"edit": "remove", "actor": "van-1"},
      {"edit": "model", "actor": "pedestrian-2", "model": "box.obj"}])"));
  ASSERT_EQ(actors.size(), 2u);
  EXPECT_EQ(actors[0].name, "pedestrian-2");
  EXPECT_EQ(actors[0].model.surface.size(), 1u);
  EXPECT_EQ(actors[1].name, "second");
  EXPECT_EQ(actors[1].from_s, 2);
}

TEST_F(EditFile, ThatCannotBeAppliedIsNamedWithItsPlace) {
  const Json remove{{"edit", "remove"}, {"actor", "van-1"}};
  EXPECT_NE(said_of(Json::array({remove, remove})).find("edits[1].actor: there is no such actor"),
            std::string::npos);
  EXPECT_NE(
      said_of(Json::array({Json{{"edit", "paint"}, {"actor", "van-1"}}})).find("edits[0].edit"),
      std::string::npos);
  const Json half{{"edit", "shift"}, {"actor", "van-1"}, {"translation_m", {1, 0, 0}}, {"at_s", 1}};
  const std::string said = said_of(Json::array({half}));
  EXPECT_NE(said.find("edits[0]: at_s and within_s need each other"), std::string::npos) << said;
  EXPECT_EQ(said.find("edits[0]"), said.rfind("edits[0]")) << said;
  elements::Scene still;
  elements::SceneInfo info;
  still.models.push_back(sheet());
  still.instances.emplace_back();
  info.names = {"wall"};
  info.labels = {elements::Class::kUnknown};
  elements::write_scene(folder_ / "still", still, info);
  EXPECT_THROW(read_actors(folder_ / "still"), FormatError);
  EXPECT_THROW(read_actors(folder_ / "path.txt"), FormatError);
}

}  // namespace
}  // namespace underbrush::actors
