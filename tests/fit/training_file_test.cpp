#include "underbrush/fit/training_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "drive_past.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/fit/fit.hpp"

namespace underbrush::fit {
namespace {
namespace fs = std::filesystem;

class TrainingFile : public testing::Test {
 protected:
  TrainingFile() {
    folder_ = fs::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    elements::Model truth = test::flat_ground(30);
    test::add_bush({0, -8, 1.2f}, {0.3, 0.3, 0.2}, 0.6f, truth);
    const BeamLog log = test::drive_past(truth, 1, 6000, 3000, -0.4);
    MemorySource source(log);
    training_.options.tiles.tile_m = 12;
    training_.options.tau = 2.7182818284590451;
    training_.options.volumetric.hierarchical.min_points = 4;
    training_.options.seed = UINT64_MAX;
    training_.options.sensor = "velodyne-hdl64e";
    training_.footprint = true;
    training_.logs = {{"some folder/log.ply", "xxh3:12", 6000}, {"b.ply", "xxh3:34", 5}};
    result_ = fit(source, training_.options);
    training_.record = result_.record;
    training_.record.tiles[1].later = 77;
    training_.record.tiles[1].unexplained = 7;
    write();
  }
  ~TrainingFile() override { fs::remove_all(folder_); }

  void write() {
    elements::write_model(folder_, result_.model,
                          [&](const fs::path& to) { write_training(to, training_); });
  }

  fs::path folder_;
  Training training_;
  FitResult result_;
};

TEST_F(TrainingFile, IsReadAsItWasWritten) {
  ASSERT_TRUE(has_training(folder_));
  const Training t = read_training(folder_);
  EXPECT_EQ(t.options.tau, training_.options.tau);
  EXPECT_EQ(t.options.volumetric.hierarchical.min_points, 4);
  EXPECT_EQ(t.options.tiles.tile_m, 12);
  EXPECT_EQ(t.options.seed, UINT64_MAX);
  EXPECT_EQ(t.options.sensor, "velodyne-hdl64e");
  EXPECT_TRUE(t.footprint);
  ASSERT_EQ(t.logs.size(), 2u);
  EXPECT_EQ(t.logs[0].file, "some folder/log.ply");
  EXPECT_EQ(t.logs[1].hash, "xxh3:34");
  EXPECT_EQ(t.logs[1].beams, 5u);
  EXPECT_EQ(t.record.tile_m, training_.record.tile_m);
  EXPECT_FALSE(t.record.residuals.empty());
  EXPECT_EQ(t.record.residuals, training_.record.residuals);
  ASSERT_EQ(t.record.tiles.size(), training_.record.tiles.size());
  for (size_t k = 0; k < t.record.tiles.size(); ++k) {
    const TileRecord &a = t.record.tiles[k], &b = training_.record.tiles[k];
    EXPECT_EQ(a.key, b.key);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.later, b.later);
    EXPECT_EQ(a.unexplained, b.unexplained);
    EXPECT_EQ(a.ellipsoids, b.ellipsoids);
    EXPECT_EQ(a.ground.n, b.ground.n);
    EXPECT_EQ(a.ground.z, b.ground.z);
    EXPECT_EQ(a.ground.zz, b.ground.zz);
    ASSERT_EQ(a.ground.nodes.size(), b.ground.nodes.size());
    for (size_t n = 0; n < a.ground.nodes.size(); ++n) {
      EXPECT_EQ(a.ground.nodes[n].block, b.ground.nodes[n].block);
      EXPECT_EQ(a.ground.nodes[n].place, b.ground.nodes[n].place);
      EXPECT_EQ(a.ground.nodes[n].sums.b, b.ground.nodes[n].sums.b);
      for (int c = 0; c < ground::kPointCouplings; ++c) {
        EXPECT_EQ(a.ground.nodes[n].sums.a[c], b.ground.nodes[n].sums.a[c]);
      }
    }
  }
}

TEST_F(TrainingFile, ModelWithoutOneIsSeen) {
  elements::write_model(folder_, result_.model);
  EXPECT_FALSE(has_training(folder_));
}

TEST_F(TrainingFile, DamageIsRefused) {
  for (const char* name : {"training.json", "tiles.ply", "ground.ply", "residuals.ply"}) {
    const fs::path file = folder_ / "training" / name;
    fs::resize_file(file, fs::file_size(file) * 2 / 3);
    EXPECT_THROW(read_training(folder_), FormatError) << name;
    fs::remove(file);
    EXPECT_THROW(read_training(folder_), FormatError) << name;
    write();
  }
}

TEST_F(TrainingFile, LiesAreRefused) {
  const fs::path file = folder_ / "training" / "training.json";
  const std::string good = read_file(file);
  const std::pair<std::string, std::string> lies[] = {
      {R"("tile_m": 12.0)", R"("tile_m": 2147483648)"},
      {R"("file": "b.ply")", R"("file": "")"},
      {R"("start": "hierarchical")", R"("start": "")"},
      {R"("fitter": "likelihood")", R"("fitter": "x")"}};
  for (const auto& [truth, lie] : lies) {
    std::string text = good;
    ASSERT_NE(text.find(truth), text.npos) << text;
    fs::remove(file);
    write_file(file, text.replace(text.find(truth), truth.size(), lie));
    EXPECT_THROW(read_training(folder_), FormatError) << lie;
  }
}

TEST_F(TrainingFile, TablesThatDisagreeAreRefused) {
  training_.record.tiles[0].ground.z = NAN;
  write();
  EXPECT_THROW(read_training(folder_), FormatError);
  training_.record.tiles[0].ground.z = 0;
  std::swap(training_.record.tiles[0], training_.record.tiles[1]);
  write();
  EXPECT_THROW(read_training(folder_), FormatError);
  std::swap(training_.record.tiles[0], training_.record.tiles[1]);
  training_.record.tiles[0].ground.nodes[0].place = UINT16_MAX;
  write();
  EXPECT_THROW(read_training(folder_), FormatError);
}

}  // namespace
}  // namespace underbrush::fit
