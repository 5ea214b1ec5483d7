// The published schema of scene.json and the reader have the same members.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/elements/scene_file.hpp"

namespace underbrush::elements {
namespace {

using Json = nlohmann::json;

class SceneSchema : public testing::Test {
 protected:
  SceneSchema() {
    std::ifstream(UNDERBRUSH_TEST_SCHEMAS "/scene.json") >> schema_;
    Scene scene;
    SceneInfo info;
    scene.models.emplace_back().fitter = "test";
    scene.instances.emplace_back();
    info.names = {"a model"};
    info.labels = {class_named(info, "wall")};
    info.materials = {"plaster"};
    info.own_materials = {{"plaster", {{532e-9, 0.5}, {1064e-9, 0.75}}}};
    info.movers.push_back({0, Trajectory({{0, {}}, {1, {}}}), 0.25, 0.75});
    write_scene(folder_ / "scene", scene, info);
    std::ifstream(folder_ / "scene/scene.json") >> good_;
    good_["comment"] = "any";
    good_["$schema"] = "scene.json";
  }

  /// Returns what the reader says of this manifest; empty if it accepts it.
  std::string said_of(const Json& manifest) {
    std::ofstream(folder_ / "scene/scene.json") << manifest;
    try {
      read_scene(folder_ / "scene");
      return "";
    } catch (const FormatError& e) {
      return e.what();
    }
  }

  /// The part of the schema that `of` refers to, or itself.
  const Json& resolved(const Json& of) {
    if (!of.contains("$ref")) return of;
    return schema_["$defs"][of["$ref"].get<std::string>().substr(8)];
  }

  /// Tries every member of the object at `at`, which `described` describes.
  void try_members(const Json::json_pointer& at, const Json& described) {
    const Json& here = good_[at];
    for (const auto& [name, member] : described["properties"].items()) {
      ASSERT_TRUE(here.contains(name)) << at << "/" << name << " is missing in the good manifest";
      const auto& required = described["required"];
      Json less = good_;
      less[at].erase(name);
      const std::string said = said_of(less);
      if (name == "classes") {  // The file of instances has one of them.
        EXPECT_NE(said.find("an unknown class"), std::string::npos) << said;
      } else if (std::find(required.begin(), required.end(), name) == required.end()) {
        EXPECT_EQ(said, "") << at << "/" << name;
      } else {
        EXPECT_NE(said.find("'" + name + "'"), std::string::npos)
            << at << "/" << name << ": " << said;
      }
      ++tried_;
      const Json& kind = resolved(member);
      if (kind.empty()) continue;  // anything
      if (name != "$schema") {
        Json wrong = good_;
        wrong[at][name] = kind.value("type", "") == "object" ? Json(7) : Json::object();
        if (name != "provenance") {
          EXPECT_NE(said_of(wrong).find(name), std::string::npos)
              << at << "/" << name << ": " << said_of(wrong);
        }
      }
      if (kind.value("type", "") == "object" && kind.contains("properties"))
        try_members(at / name, kind);
      if (kind.contains("items") && resolved(kind["items"]).contains("properties")) {
        try_members(at / name / 0, resolved(kind["items"]));
      }
    }
    Json more = good_;
    more[at]["unheard_of"] = 1;
    EXPECT_NE(said_of(more).find("unheard_of"), std::string::npos) << at << ": " << said_of(more);
  }

  io::TemporaryFolder folder_;
  Json schema_, good_;
  size_t tried_ = 0;
};

TEST_F(SceneSchema, HasTheMembersOfTheReader) {
  EXPECT_EQ(said_of(good_), "");
  try_members(Json::json_pointer(""), schema_);
  EXPECT_EQ(tried_, 22u);
}

TEST_F(SceneSchema, ClassesAndMaterialsComeBack) {
  SceneInfo info;
  ASSERT_EQ(said_of(good_), "");
  read_scene(folder_ / "scene", &info);
  EXPECT_EQ(info.class_names, std::vector<std::string>{"wall"});
  EXPECT_EQ(class_name(info, info.labels.at(0)), "wall");
  ASSERT_EQ(info.own_materials.size(), 1u);
  EXPECT_EQ(info.own_materials[0].reflectance.size(), 2u);
  EXPECT_DOUBLE_EQ(info.own_materials[0].reflectance[1].second, 0.75);
}

TEST_F(SceneSchema, ValuesOutOfRangeAreNamed) {
  for (const auto& [at, value, said] :
       {std::tuple<const char*, Json, const char*>{
            "/materials/0/reflectance", {0.5, 1.5}, "materials[0].reflectance"},
        {"/materials/0/reflectance", {0.5}, "materials[0].reflectance"},
        {"/materials/0/wavelength_nm", {700, 600}, "materials[0].wavelength_nm"},
        {"/classes", {"wall", "wall"}, "classes[1]"},
        {"/classes", {"ground"}, "classes[0]"},
        {"/classes", {""}, "classes[0]"},
        {"/classes", Json::array(), "instances.ply"},
        {"/movers/0/instance", 7, "movers[0].instance"},
        {"/models/0/folder", "../scene/models/0000", "models[0].folder"}}) {
    Json bad = good_;
    bad[Json::json_pointer(at)] = value;
    EXPECT_NE(said_of(bad).find(said), std::string::npos) << at << ": " << said_of(bad);
  }
}

}  // namespace
}  // namespace underbrush::elements
