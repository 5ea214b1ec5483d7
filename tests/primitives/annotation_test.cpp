#include "underbrush/primitives/annotation.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "io/temporary.hpp"
#include "primitives/sites.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

using Folder = io::TemporaryFolder;

TEST(Annotation, ComesBack) {
  const Folder folder;
  Stream random(1);
  Annotation a;
  a.ground = folder / "site.ground";
  for (uint32_t k = 0; k < 200; ++k) {
    PlacedObject o;
    o.label = elements::Class(3 + k % 11);
    for (int d = 0; d < 3; ++d) {
      o.position[d] = random.uniform(-500, 500);
      o.box.min[d] = random.uniform(-3, 0);
      o.box.max[d] = random.uniform(0.1, 9);
    }
    o.yaw_rad = random.uniform(-1.5, 1.5);
    o.instance = k;
    o.points = 10 * k;
    for (double& z : o.layers.z) z = as_written(random.uniform());
    for (auto* layers : {&o.layers.x, &o.layers.y}) {
      for (auto& places : *layers) {
        for (double& at : places) at = as_written(random.uniform(-2, 2));
      }
    }
    if (k % 7 == 0) o.layers = {};  // not known
    if (k % 5) o.beams = {{double(k), 0, 3}, {random.uniform(1, 9), 2.5, 1000.125}};
    if (k % 50 == 0) o.trajectory = folder / ("poses" + std::to_string(k) + ".txt");
    a.objects.push_back(o);
  }
  write_annotation(folder / "a.json", a);
  const Annotation b = read_annotation(folder / "a.json");
  EXPECT_EQ(std::filesystem::weakly_canonical(b.ground),
            std::filesystem::weakly_canonical(a.ground));
  ASSERT_EQ(b.objects.size(), a.objects.size());
  for (size_t k = 0; k < a.objects.size(); ++k) {
    EXPECT_EQ(b.objects[k].label, a.objects[k].label);
    EXPECT_LT((b.objects[k].position - a.objects[k].position).norm(), 1e-3);
    EXPECT_LT((b.objects[k].box.min - a.objects[k].box.min).norm(), 1e-3);
    EXPECT_LT((b.objects[k].box.max - a.objects[k].box.max).norm(), 1e-3);
    EXPECT_NEAR(b.objects[k].yaw_rad, a.objects[k].yaw_rad, 1e-5);
    EXPECT_EQ(b.objects[k].instance, a.objects[k].instance);
    EXPECT_EQ(b.objects[k].points, a.objects[k].points);
    EXPECT_EQ(b.objects[k].layers, a.objects[k].layers);
    EXPECT_EQ(b.objects[k].beams.returns, a.objects[k].beams.returns);
    EXPECT_EQ(b.objects[k].beams.path_m, a.objects[k].beams.path_m);
    EXPECT_EQ(b.objects[k].trajectory, a.objects[k].trajectory);
  }
  write_annotation(folder / "b.json", b);  // a second writing gives the same bytes
  std::ifstream first(folder / "a.json"), second(folder / "b.json");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(first), {}),
            std::string(std::istreambuf_iterator<char>(second), {}));
}

// The published schema and the program have the same classes.
TEST(Annotation, QuantilesOfAllPointsAreThoseOfEveryLayer) {
  const io::TemporaryFolder folder;
  std::ofstream(folder / "a.json") << R"({"format": "underbrush-annotation", "version": 1,
    "ground": "ground", "objects": [{"class": "large_tree", "position_m": [0, 0],
    "box_m": {"size": [2, 2, 3]},
    "quantiles_m": [[-1, -2, 0], [0, -1, 1], [1, 0, 2], [2, 1, 2.5], [3, 2, 3]]}]})";
  const PointLayers layers = read_annotation(folder / "a.json").objects.at(0).layers;
  EXPECT_EQ(layers.z, (PointLayers::Places{0, 1, 2, 2.5, 3}));
  for (size_t l = 0; l < 5; ++l) {
    EXPECT_EQ(layers.x[l], (PointLayers::Places{-1, 0, 1, 2, 3}));
    EXPECT_EQ(layers.y[l], (PointLayers::Places{-2, -1, 0, 1, 2}));
  }
}

TEST(Annotation, SchemaListsTheClasses) {
  std::string schema = io::bytes_of(UNDERBRUSH_TEST_SCHEMAS "/annotation.json");
  const size_t begin = schema.find("\"enum\"");
  ASSERT_NE(begin, std::string::npos);
  schema = schema.substr(begin, schema.find(']', begin) - begin);
  for (const std::string_view name : elements::kClassNames) {
    const bool object =
        elements::kind_of(*elements::class_from_name(name)) != elements::ClassKind::kOther;
    EXPECT_EQ(schema.find('"' + std::string(name) + '"') != std::string::npos, object) << name;
  }
}

constexpr const char* kHead = R"({"format": "underbrush-annotation", "version": 1, "ground": "g",)";

TEST(Annotation, ByHandNeedsLittle) {
  const Folder folder;
  std::ofstream(folder / "a.json") << kHead << R"( "objects": [
    {"class": "large_tree", "position_m": [3, 4], "box_m": {"size": [4, 3, 12]}}]})";
  const Annotation a = read_annotation(folder / "a.json");
  ASSERT_EQ(a.objects.size(), 1u);
  EXPECT_EQ(a.objects[0].label, elements::Class::kLargeTree);
  EXPECT_EQ(a.objects[0].box.min, Vec3(-2, -1.5, 0));
  EXPECT_EQ(a.objects[0].box.max, Vec3(2, 1.5, 12));
  std::ofstream(folder / "none.json") << kHead << R"( "objects": []})";
  EXPECT_TRUE(read_annotation(folder / "none.json").objects.empty());
}

void expect_refused(const std::string& text, const std::string& place, const std::string& why) {
  const Folder folder;
  std::ofstream(folder / "a.json") << text;
  try {
    read_annotation(folder / "a.json");
    ADD_FAILURE() << text;
  } catch (const FormatError& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find(place), std::string::npos) << what;
    EXPECT_NE(what.find(why), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST(Annotation, ThatIsWrongSaysWhere) {
  const auto object = [&](const std::string& members) {
    return std::string(kHead) + R"( "objects": [{"class": "large_tree", "position_m": [1, 2],
      "box_m": {"size": [1, 1, 1]}}, {)" +
           members + "}]}";
  };
  const std::string box = R"("box_m": {"size": [1, 1, 1]})", at = R"("position_m": [1, 2, 3])";
  expect_refused(object(R"("class": "large_tre", )" + at + "," + box), "objects[1].class",
                 "'large_tree'");
  expect_refused(object(R"("class": "ground", )" + at + "," + box), "objects[1].class", "ground");
  expect_refused(object(R"("class": 7, )" + at + "," + box), "objects[1].class", "name");
  expect_refused(object(at + "," + box), "objects[1]", "'class'");
  expect_refused(object(R"("class": "large_tree", )" + box), "objects[1]", "'position_m'");
  expect_refused(object(R"("class": "large_tree", )" + at), "objects[1]", "'box_m'");
  expect_refused(object(R"("class": "large_tree", )" + at + R"(, "box_m": {"size": [1, 0, 1]})"),
                 "objects[1].box_m", "extent");
  expect_refused(
      object(R"("class": "large_tree", )" + at + R"(, "box_m": {"min": [0,0,0], "max": [1,-1,1]})"),
      "objects[1].box_m", "extent");
  expect_refused(object(R"("class": "large_tree", "position_m": [1, NaN, 2], )" + box), "line 2",
                 "NaN");
  expect_refused(object(R"("class": "large_tree", "quantiles_m": [[1, 2, 3]], )" + at + "," + box),
                 "objects[1].quantiles_m", "5 places");
  const auto layers = [&](const char* json) {
    return object(R"("class": "large_tree", "layers_m": )" + std::string(json) + "," + at + "," +
                  box);
  };
  expect_refused(layers(R"({"z": [1, 2, 3, 4, 5], "x": []})"), "objects[1].layers_m.x", "5 layers");
  expect_refused(layers(R"({"z": [1, 2, 3, 4], "x": [], "y": []})"), "objects[1].layers_m.z",
                 "5 numbers");
  expect_refused(layers(R"({"z": [1, 2, 3, 4, 1e308], "x": [], "y": []})"), "objects[1].layers_m.z",
                 "100 km");
  expect_refused(layers(R"({"x": [], "y": []})"), "objects[1].layers_m", "'z'");
  expect_refused(layers(R"({"z": [1, 2, 3, 4, 5], "w": []})"), "objects[1].layers_m", "'w'");
  const auto beams = [&](const char* json) {
    return object(R"("class": "large_tree", "beams": )" + std::string(json) + "," + at + "," + box);
  };
  expect_refused(beams(R"({"returns": [1, 2, 3]})"), "objects[1].beams", "'path_m'");
  expect_refused(beams(R"({"returns": [1, 2], "path_m": []})"), "objects[1].beams.returns", "3");
  expect_refused(beams(R"({"returns": [1, 2, 3], "path_m": [1, -2, 3]})"),
                 "objects[1].beams.path_m", "0 to 1e15");
  expect_refused(beams(R"({"returns": [1, 2, 3], "path_m": [1, 2, 3], "x": 1})"),
                 "objects[1].beams", "'x'");
  expect_refused(object(R"("class": "large_tree", "position_m": [1, null, 2], )" + box),
                 "objects[1].position_m[1]", "finite");
  expect_refused(object(R"("class": "large_tree", "position_m": [1, 1e999, 2], )" + box), "",
                 "JSON");
  expect_refused(object(R"("class": "large_tree", "position": [1, 2], )" + box), "objects[1]",
                 "'position_m'");
  expect_refused(std::string(kHead) + R"( "objects": {}})", "objects", "list");
  expect_refused(R"({"format": "underbrush-annotation", "version": 1, "objects": []})", "",
                 "'ground'");
  expect_refused(
      R"({"format": "underbrush-annotation", "version": 2, "ground": "g", "objects": []})",
      "version", "newer");
  expect_refused(R"({"format": "other", "version": 1, "ground": "g", "objects": []})", "format",
                 "not an");
  expect_refused("[1, 2]", "", "object");
  expect_refused("", "", "JSON");
}

}  // namespace
}  // namespace underbrush::primitives
