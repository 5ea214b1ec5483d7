#include <cmath>

#include "underbrush/core/rng.hpp"
#include "worlds/helios_files.hpp"

namespace underbrush::worlds {
namespace {

Vec3 corner(const World& w, size_t instance, size_t v) {
  const elements::Instance& i = w.scene.instances.at(instance);
  return i.world_from_model.translation +
         double(i.scale) * (i.world_from_model.rotation *
                            w.scene.models[i.model].surface.vertices.at(v).cast<double>());
}

// Law: a chain of filters is translation · scale · product of the rotations, whatever their order.
TEST_F(Helios, AChainOfFiltersIsTheProductOfItsMatrices) {
  Stream random(11);
  for (int round = 0; round < 20; ++round) {
    Mat3 expected = Mat3::Identity();
    std::string parts = "<part>" + kObj, turns;
    std::string two[2];
    for (auto& chain : two) {
      const bool local = random.uniform() < 0.5;
      Mat3 one = Mat3::Identity();
      turns = "";
      for (int k = 0; k < 3; ++k) {
        const auto axis = Eigen::Index(random.below(3));
        const double angle = random.uniform(-180, 180);
        const Mat3 r = Eigen::AngleAxisd(angle * M_PI / 180, Vec3::Unit(axis)).toRotationMatrix();
        one = local ? Mat3(one * r) : Mat3(r * one);
        char text[128];
        std::snprintf(text, sizeof text, "<rot axis=\"%c\" angle_deg=\"%.17g\"/>", "xyz"[axis],
                      angle);
        turns += text;
      }
      expected = one * expected;
      chain = filter("rotate", std::string("<param type=\"rotation\" key=\"rotation\"") +
                                   (local ? " rotations=\"local\">" : ">") + turns + "</param>");
    }
    // The last scale and the last offset count, and a translation comes after all.
    parts += filter("translate", param("offset", "7;7;7")) + two[0] +
             filter("scale", param("scale", "9")) + two[1] +
             filter("scale", param("scale", "2.5")) +
             filter("translate", param("offset", "412345.5;-5.25;100")) + "</part>";
    const World w = read_helios_scene(scene(parts));
    ASSERT_EQ(w.scene.instances.size(), 2u);
    const Vec3 corners[3] = {{1, 2, 3}, {4, 5, 6.5}, {-1, 0.25, 2}};
    for (size_t k = 0; k < 3; ++k) {
      const Vec3 right = 2.5 * expected * corners[k] + Vec3(412345.5, -5.25, 100);
      EXPECT_LT((corner(w, 1, k) - right).norm(), 1e-5) << round;
    }
  }
}

TEST_F(Helios, PartsShareAFileAndStandOnTheGround) {
  const std::string ground =
      "<part>" + filter("objloader", param("filepath", "parts/ground.obj")) + "</part>";
  const std::string on =
      filter("translate", "<param type=\"integer\" key=\"onGround\" value=\"-1\"/>" +
                              param("offset", "0;50;80"));
  const World w = read_helios_scene(
      scene("<part>" + kObj + on + "</part><part>" + kObj + "</part>" + ground + "<part>" +
            filter("objloader", param("filepath", "parts/a.obj") + param("up", "y")) + "</part>"));
  EXPECT_EQ(w.scene.instances.size(), 5u);
  EXPECT_EQ(w.scene.models.size(), 4u);  // nothing, a, ground, a with y up
  EXPECT_NEAR(ground_at(w, 0, 50).value(), 5, 1e-5);
  EXPECT_FALSE(ground_at(w, 500, 500).has_value());
  EXPECT_NEAR(corner(w, 1, 2).z(), 5, 1e-5);  // its lowest corner
  EXPECT_NEAR(corner(w, 4, 0).z(), 2, 1e-6);  // y of the file
  EXPECT_NEAR(corner(w, 4, 0).y(), -3, 1e-6);
}

// A map of 3 × 2 cells of 1 m, 300 m high; one cell at its edge has no height.
std::string map_in(uint16_t linear_unit) {
  std::string bytes("II*\0", 4), entries;
  const auto add = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  constexpr uint32_t kScale = 8 + 24, kTie = kScale + 24, kKeys = kTie + 48, kEnd = kKeys + 16;
  add(bytes, kEnd);
  for (const float z : {300.0F, 300.0F, -3.4e38F, 300.0F, 300.0F, 300.0F}) add(bytes, z);
  for (const double x : {1.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0}) add(bytes, x);
  for (const int key : {1, 1, 0, 1, 3076, 0, 1, int(linear_unit)}) add(bytes, uint16_t(key));
  const std::vector<std::array<uint32_t, 4>> tags{
      {256, 4, 1, 3},       {257, 4, 1, 2},      {258, 4, 1, 32}, {273, 4, 1, 8},
      {278, 4, 1, 2},       {279, 4, 1, 24},     {339, 4, 1, 3},  {33550, 12, 3, kScale},
      {33922, 12, 6, kTie}, {34735, 3, 8, kKeys}};
  add(bytes, uint16_t(tags.size()));
  for (const auto& [tag, type, n, value] : tags) {
    add(bytes, uint16_t(tag));
    add(bytes, uint16_t(type));
    add(bytes, n);
    add(bytes, value);
  }
  return bytes + std::string(4, '\0');
}

TEST_F(Helios, TerrainWithoutAHeightInACellIsTheRest) {
  write("parts/metre.tif", map_in(9001));
  write("parts/foot.tif", map_in(9002));
  const std::string metre = filter("geotiffloader", param("filepath", "parts/metre.tif")),
                    foot = filter("geotiffloader", param("filepath", "parts/foot.tif"));
  const World w = read_helios_scene(scene("<part>" + metre + "</part>"));
  EXPECT_NEAR(ground_at(w, 0, 0).value(), 300, 1e-4);
  EXPECT_FALSE(ground_at(w, 1, 0.4).has_value());
  EXPECT_EQ(w.report.triangles, 2u);
  EXPECT_EQ(w.report.left_out.size(), 1u);
  // A part stands on the ground with its lowest point, which a cell without a height has not.
  const World on = read_helios_scene(scene("<part>" + metre +
                                           filter("translate",
                                                  "<param type=\"integer\" key=\"onGround\" "
                                                  "value=\"-1\"/>") +
                                           "</part><part>" + kObj + "</part>"));
  EXPECT_NEAR(ground_at(on, 0, 0).value(), 300, 1e-4);
  EXPECT_NE(refused(scene("<part>" + foot + "</part>")).find("in feet"), std::string::npos);
  const std::string scaled =
      foot + filter("scale", "<param type=\"double\" key=\"scale\" value=\"0.3048\"/>");
  EXPECT_NEAR(ground_at(read_helios_scene(scene("<part>" + scaled + "</part>")), 0, 0).value(),
              91.44, 1e-4);
}

TEST_F(Helios, WhatIsNotKnownIsCounted) {
  const World w =
      read_helios_scene(scene("<weather/><part>" + kObj + "<swap/><swap/>" + filter("bend", "") +
                              "</part><part>" + filter("curveloader", "") + "</part><part>" +
                              filter("objloader", param("efilepath", "parts/.*.obj")) + "</part>"));
  EXPECT_EQ(w.report.parts, 1u);
  EXPECT_EQ(w.report.left_out.at("elements weather in scene"), 1u);
  EXPECT_EQ(w.report.left_out.at("elements swap in part"), 2u);
  EXPECT_EQ(w.report.left_out.at("filters bend"), 1u);
  EXPECT_EQ(w.report.left_out.at("filters curveloader"), 1u);
  EXPECT_EQ(w.report.left_out.at("loaders with an efilepath"), 1u);
  EXPECT_EQ(w.report.left_out.at("parts without a geometry that can be read"), 2u);
}

TEST_F(Helios, RefusesBombsAndPathsThatLeadOut) {
  EXPECT_NE(refused(write("x.xml", "<!DOCTYPE a [<!ENTITY b \"c\">]>\n<document/>"))
                .find("document type"),
            std::string::npos);
  EXPECT_NE(
      refused(write("y.xml", "<?xml version=\"1.0\"?>\n\n<!DOCTYPE a SYSTEM \"/etc/passwd\"><a/>"))
          .find("line 3"),
      std::string::npos);
  for (const std::string& path :
       {std::string("../a.obj"), std::string("/etc/passwd"), std::string("parts/../../a.obj")}) {
    const std::string said =
        refused(scene("<part>" + filter("objloader", param("filepath", path)) + "</part>"));
    EXPECT_NE(said.find("leads out"), std::string::npos) << said;
  }
  const std::string absent =
      refused(scene("<part>" + filter("objloader", param("filepath", "b.obj")) + "</part>"));
  EXPECT_NE(absent.find("--assets"), std::string::npos) << absent;
  for (const char* text : {"", "<", "<document>", "<document/>", "<document><scene/></document>",
                           "text", "<document><scene><part/></scene></document>"}) {
    EXPECT_NE(refused(write("z.xml", text)), "") << text;
  }
  std::string deep;
  for (int k = 0; k < 1000000; ++k) deep += "<a>";
  EXPECT_NE(refused(write("deep.xml", deep)), "");
  for (const char* bad :
       {"<param key=\"scale\" value=\"x\"/>", "<param key=\"scale\" value=\"-1\"/>",
        "<param key=\"scale\" value=\"1e999\"/>"}) {
    EXPECT_NE(refused(scene("<part>" + kObj + filter("scale", bad) + "</part>")).find("line 3"),
              std::string::npos);
  }
  EXPECT_NE(
      refused(scene("<part>" + kObj + filter("translate", param("offset", "1;2")) + "</part>")),
      "");
  for (const std::string turn : {"axis=\"w\" angle_deg=\"3\"", "axis=\"z\" angle_rad=\"3\""}) {
    const std::string rotation = "<param key=\"rotation\"><rot " + turn + "/></param>";
    EXPECT_NE(refused(scene("<part>" + kObj + filter("rotate", rotation) + "</part>")), "");
  }
}

}  // namespace
}  // namespace underbrush::worlds
