#include "underbrush/elements/model_file.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <sstream>

#include "trace/scenes.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::elements {
namespace {
namespace fs = std::filesystem;

class ModelFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("underbrush-test-" + std::to_string(getpid()) + "-" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    model_ = trace::random_model(4, 50, Vec3(5e5, -4e6, 123.456));
    model_.fitter = "hierarchical";
    model_.max_range_m = 80;
    model_.class_names = {"tree", "fence"};
    model_.grain = {0.03, 0.07, {{15, 0.3}, {2, 0.01}}};
    model_.range_noise_m = 0.011;
    model_.sway_s = 0.25;
    model_.leaf_angles = LeafAngleDistribution(1.75);
    model_.sensor = "own";
    model_.sensor_file = "name: own\nkind: \"spinning\"\n";
    model_.channels = {{0, 0.0213, 0.0011}, {7, -0.0213, 0.0009}};
    model_.all_echoes = true;
    model_.provenance = R"({"seed":1})";
  }
  void TearDown() override { fs::remove_all(folder_); }
  void replace(const std::string& from, const std::string& to) {
    std::ostringstream text;
    text << std::ifstream(folder_ / "m" / "model.json").rdbuf();
    std::string s = text.str();
    const size_t at = s.find(from);
    ASSERT_NE(at, std::string::npos);
    std::ofstream(folder_ / "m" / "model.json") << s.replace(at, from.size(), to);
  }
  fs::path folder_;
  Model model_;
};

TEST_F(ModelFile, RefusesAGrainOfAClassThatItDoesNotHave) {
  write_model(folder_ / "m", model_);
  replace("\"fence\": 0.3", "\"hedge\": 0.3");
  try {
    read_model(folder_ / "m");
    FAIL();
  } catch (const FormatError& e) {
    EXPECT_NE(std::string(e.what()).find("grain_m.classes.hedge: not a class of the model"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(ModelFile, RefusesAGrainThatIsNotOfTheModel) {
  for (const elements::Grain& bad :
       {Grain{0.03, 0.07, {{2, 0.01}, {2, 0.02}}}, Grain{0.03, 0.07, {{2, -1.0}}},
        Grain{0.03, 0.07, {{99, 0.01}}}, Grain{0.03, 0.07, std::vector<ClassGrain>(8)}}) {
    model_.grain = bad;
    EXPECT_THROW(model_.check(), std::invalid_argument);
  }
}

TEST_F(ModelFile, ComesBackWhole) {
  model_.ellipsoids[3].hit = {0.25f, 11, 12};
  model_.ellipsoids[3].label = 70;
  write_model(folder_ / "m", model_);
  const Model back = read_model(folder_ / "m");
  EXPECT_EQ(back.origin, model_.origin);
  EXPECT_EQ(back.tau, model_.tau);
  EXPECT_EQ(back.max_range_m, 80);
  EXPECT_EQ(back.grain.ellipsoid_m, 0.03);
  EXPECT_EQ(back.grain.mesh_m, 0.07);
  EXPECT_EQ(back.class_names, model_.class_names);
  ASSERT_EQ(back.grain.classes.size(), 2u);
  EXPECT_EQ(back.grain.side_at(back.grain.place_of(15)), 0.3);
  EXPECT_EQ(back.grain.side_at(back.grain.place_of(2)), 0.01);
  EXPECT_EQ(back.grain.side_at(back.grain.place_of(14)), 0.03);
  EXPECT_EQ(back.range_noise_m, 0.011);
  EXPECT_EQ(back.sway_s, 0.25);
  EXPECT_EQ(back.leaf_angles.shape(), 1.75);
  EXPECT_EQ(back.sensor, model_.sensor);
  EXPECT_EQ(back.sensor_file, model_.sensor_file);
  ASSERT_EQ(back.channels.size(), 2u);
  EXPECT_EQ(back.channels[1].ring, 7);
  EXPECT_EQ(back.channels[1].range_m, -0.0213);
  EXPECT_EQ(back.channels[1].standard_error_m, 0.0009);
  EXPECT_TRUE(back.all_echoes);
  EXPECT_EQ(back.fitter, model_.fitter);
  EXPECT_EQ(back.provenance, model_.provenance);
  EXPECT_EQ(back.ground.vertices, model_.ground.vertices);
  EXPECT_EQ(back.ground.triangles, model_.ground.triangles);
  EXPECT_EQ(back.surface.vertices, model_.surface.vertices);
  EXPECT_EQ(back.surface.range_sigma_m, model_.surface.range_sigma_m);
  EXPECT_EQ(back.ground.roughness_m, model_.ground.roughness_m);
  ASSERT_EQ(back.ellipsoids.size(), model_.ellipsoids.size());
  for (size_t i = 0; i < back.ellipsoids.size(); ++i) {
    EXPECT_EQ(back.ellipsoids[i].mean, model_.ellipsoids[i].mean);
    EXPECT_EQ(back.ellipsoids[i].covariance, model_.ellipsoids[i].covariance);
    EXPECT_EQ(back.ellipsoids[i].hit.p, model_.ellipsoids[i].hit.p);
    EXPECT_EQ(back.ellipsoids[i].hit.misses, model_.ellipsoids[i].hit.misses);
    EXPECT_EQ(back.ellipsoids[i].label, model_.ellipsoids[i].label);
  }
}

TEST_F(ModelFile, KeepsTheRoughnessOfItsTrianglesAndHasNoneWithout) {
  model_.ground.roughness.clear();
  model_.surface.roughness.clear();
  write_model(folder_ / "m", model_);
  EXPECT_TRUE(read_model(folder_ / "m").ground.roughness.empty());
  for (size_t k = 0; k < model_.ground.size(); ++k) {
    model_.ground.roughness.push_back(0.01f + 0.001f * float(k));
  }
  write_model(folder_ / "m", model_);
  const Model back = read_model(folder_ / "m");
  EXPECT_EQ(back.ground.roughness, model_.ground.roughness);
  EXPECT_TRUE(back.surface.roughness.empty());
  for (const float bad : {-0.01f, std::numeric_limits<float>::quiet_NaN()}) {
    model_.ground.roughness[0] = bad;
    EXPECT_THROW(model_.check(), std::invalid_argument);
  }
  model_.ground.roughness.resize(model_.ground.size() + 1, 0.01f);
  EXPECT_THROW(model_.check(), std::invalid_argument);
}

TEST_F(ModelFile, KeepsItsLightAndHasNoneWithout) {
  write_model(folder_ / "m", model_);
  EXPECT_FALSE(read_model(folder_ / "m").light.known());
  EXPECT_TRUE(read_model(folder_ / "m").ground.light.empty());
  model_.light.max_intensity = 255;
  model_.light.range = {{1, 10}, {1.5, 0.25}};
  model_.light.incidence[0] = {{0, 1}, {0.5, 1.125}};
  model_.light.incidence[1] = {{0.5}, {2}};
  model_.light.ring = {0.9, 1.1};
  model_.ground.light.resize(model_.ground.size(), {3, 0.5f});
  model_.ellipsoids[3].light = {7.5f, 2};
  write_model(folder_ / "m", model_);
  const Model back = read_model(folder_ / "m");
  EXPECT_EQ(back.light.max_intensity, 255);
  EXPECT_EQ(back.light.range.at, model_.light.range.at);
  EXPECT_EQ(back.light.range.gain, model_.light.range.gain);
  EXPECT_EQ(back.light.incidence[0].gain, model_.light.incidence[0].gain);
  EXPECT_EQ(back.light.incidence[1].at, model_.light.incidence[1].at);
  EXPECT_EQ(back.light.ring, model_.light.ring);
  EXPECT_EQ(back.ground.light.at(0).mean, 3);
  EXPECT_TRUE(back.surface.light.empty());
  EXPECT_EQ(back.ellipsoids[3].light.mean, 7.5f);
  EXPECT_EQ(back.ellipsoids[3].light.spread, 2);
  replace("0.25", "-1");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
}

TEST_F(ModelFile, ReplacesAModelButNothingElse) {
  write_model(folder_ / "m", model_);
  model_.tau = 2;
  write_model(folder_ / "m", model_);
  EXPECT_EQ(read_model(folder_ / "m").tau, 2);
  fs::create_directories(folder_ / "photos");
  std::ofstream(folder_ / "photos" / "cat.jpg") << "x";
  EXPECT_THROW(write_model(folder_ / "photos", model_), IoError);
  EXPECT_TRUE(fs::exists(folder_ / "photos" / "cat.jpg"));
}

TEST_F(ModelFile, ObservedSpaceThatNoMemoryHoldsIsRefused) {
  const Cell3 far[] = {{INT32_MIN, 0, 0}, {0, INT32_MIN, 0}, {0, 0, INT32_MIN}, {0, 0, -65535}};
  for (const Cell3& at : far) {
    auto space = std::make_shared<ObservedSpace>();
    space->blocks.resize(2);
    space->blocks[0].at = at;
    EXPECT_THROW(space->check(), std::invalid_argument);
    space->blocks[0].at = {-65535, 0, 0};
    EXPECT_NO_THROW(space->check());
  }
}

TEST_F(ModelFile, ObservedSpaceComesBackAndItsDamageIsNoticed) {
  ObservedSpace space;
  space.density_per_m[3][2] = 0.25f;
  space.blocks.resize(2);
  space.blocks[0].at = {-2, 5, 0};
  space.blocks[1].at = {0, -7, 1};
  space.blocks[1].beams[ObservedBlock::index({3, -56, 9})] = 200;
  space.lost = {{{-3, 2}, 7}, {{0, -1}, 70000}};
  space.ground_returns[4] = 0.75f;
  model_.observed = std::make_shared<ObservedSpace>(space);
  write_model(folder_ / "m", model_);
  const Model read = read_model(folder_ / "m");
  ASSERT_TRUE(read.observed);
  EXPECT_EQ(read.observed->density_per_m, space.density_per_m);
  ASSERT_EQ(read.observed->blocks.size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read.observed->blocks[k].at, space.blocks[k].at);
    EXPECT_EQ(read.observed->blocks[k].beams, space.blocks[k].beams);
  }
  EXPECT_EQ(read.observed->ground_returns, space.ground_returns);
  ASSERT_EQ(read.observed->lost.size(), 2u);
  EXPECT_EQ(read.observed->lost[1].at, (Cell2{0, -1}));
  EXPECT_EQ(read.observed->lost[1].beams, 70000u);
  replace("0.75", "1.75");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  replace("\"cell_m\": 1.0", "\"cell_m\": 0.0");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  replace("0.25", "-0.5");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  fs::resize_file(folder_ / "m" / "observed_space.ply", 400);
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  space.blocks[0].at = space.blocks[1].at;
  model_.observed = std::make_shared<ObservedSpace>(space);
  EXPECT_THROW(write_model(folder_ / "m", model_), std::invalid_argument);
}

TEST_F(ModelFile, DamageIsAFormatError) {
  EXPECT_THROW(read_model(folder_ / "none"), FormatError);
  EXPECT_THROW(read_model(folder_), FormatError);
  write_model(folder_ / "m", model_);
  replace("\"version\": 1", "\"version\": 99");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  replace("\"tau\"", "\"tow\"");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  fs::resize_file(folder_ / "m" / "ellipsoids.ply",
                  fs::file_size(folder_ / "m" / "ellipsoids.ply") - 1);
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
  write_model(folder_ / "m", model_);
  fs::remove(folder_ / "m" / "ground.ply");
  EXPECT_THROW(read_model(folder_ / "m"), FormatError);
}

TEST_F(ModelFile, SplatsEncodeTheSameGaussians) {
  write_splat(folder_ / "s.ply", model_);
  const io::PlyData data = io::read_ply(folder_ / "s.ply");
  const auto at = [&](const char* name, size_t i) {
    return std::get<std::vector<float>>(*data.find("vertex")->find(name))[i];
  };
  for (size_t i = 0; i < model_.ellipsoids.size(); ++i) {
    const Eigen::Quaterniond q(at("rot_0", i), at("rot_1", i), at("rot_2", i), at("rot_3", i));
    const Vec3 s(std::exp(2.0 * at("scale_0", i)), std::exp(2.0 * at("scale_1", i)),
                 std::exp(2.0 * at("scale_2", i)));
    const Mat3 r = q.toRotationMatrix();
    const Mat3 sigma = r * s.asDiagonal() * r.transpose();
    const Mat3 expected = model_.ellipsoids[i].covariance_matrix();
    EXPECT_LT((sigma - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST_F(ModelFile, MeshesGoOutAsObjAndPly) {
  write_mesh(folder_ / "g.ply", model_.ground);
  EXPECT_EQ(io::read_ply(folder_ / "g.ply").find("face")->triangles, model_.ground.triangles);
  write_mesh(folder_ / "g.obj", model_.ground);
  std::ifstream in(folder_ / "g.obj");
  size_t v = 0, f = 0;
  for (std::string line; std::getline(in, line);) {
    v += line[0] == 'v';
    f += line[0] == 'f';
  }
  EXPECT_EQ(v, model_.ground.vertices.size());
  EXPECT_EQ(f, model_.ground.size());
}

}  // namespace
}  // namespace underbrush::elements
