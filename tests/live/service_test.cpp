#include "underbrush/live/service.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <thread>

#include "io/temporary.hpp"
#include "live/site.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/live/other_worlds.hpp"

namespace underbrush::live {
namespace {

using namespace test;

/// A service of one sensor, and what it sends.
class FiringService : public testing::Test {
 protected:
  FiringService() : world_(site()), sensors_(world_, {}, sensor::load("velodyne-vlp16")) {}

  Call call() {
    return {std::chrono::system_clock::now() + std::chrono::minutes(1), [] { return false; },
            [this](Part p) {
              sent_.push_back(std::move(p));
              return true;
            }};
  }
  std::string column(size_t k) const {
    std::string all;
    for (const Part& p : sent_) all += p.columns.at(k).bytes;
    return all;
  }

  pipeline::TracedWorld world_;
  LiveSensors sensors_;
  std::vector<Part> sent_;
};

TEST_F(FiringService, SendsTheColumnsInParts) {
  const auto service = service_of(sensors_, {1 << 20, 3600, 100});
  ASSERT_TRUE(service->fire({part(3), {"range_m", "origin"}, "", ""}, call()));
  const BeamLog beams = sensors_.fire(part(3));
  ASSERT_GT(beams.size(), 200u);
  EXPECT_EQ(sent_.size(), (beams.size() + 99) / 100);
  EXPECT_EQ(sent_[1].first_row, 100u);
  EXPECT_EQ(sent_[0].columns[1].width, 3u);
  const std::string ranges = column(0), origins = column(1);
  ASSERT_EQ(ranges.size(), 4 * beams.size());
  ASSERT_EQ(origins.size(), 24 * beams.size());
  EXPECT_EQ(std::memcmp(ranges.data(), beams.range_m.data(), ranges.size()), 0);
  EXPECT_EQ(std::memcmp(origins.data(), beams.origin.data(), origins.size()), 0);
}

TEST_F(FiringService, SendsTheCloudsOfADriver) {
  const auto service = service_of(sensors_);
  ASSERT_TRUE(service->fire({part(3), {}, "velodyne", ""}, call()));
  const BeamLog beams = sensors_.fire(part(3));
  const PointCloud& cloud = sent_.at(0).clouds.at(0);
  EXPECT_EQ(cloud.point_step, 22u);
  EXPECT_EQ(cloud.bytes.size(), size_t(cloud.width) * cloud.height * cloud.point_step);
  const Trajectory path = trajectory_of(part(3).vehicle, 0);
  size_t at = 0;
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!beams.is_hit(i)) continue;
    Vec3f point;
    std::memcpy(point.data(), cloud.bytes.data() + cloud.point_step * at++, sizeof point);
    const Vec3 seen = path.at(beams.time_s[i])->inverse() * beams.end_point(i);
    ASSERT_LT((point.cast<double>() - seen).norm(), 1e-4) << "in the sensor's frame";
  }
  EXPECT_EQ(at, cloud.width);
}

TEST_F(FiringService, RefusesTooMuch) {
  const auto service = service_of(sensors_, {1000, 3600, 100});
  EXPECT_THROW(service->fire({part(7), {}, "", ""}, call()), std::invalid_argument);
  Firing late = part(1);
  late.start_s -= 3601;
  EXPECT_THROW(service->fire({late, {}, "", ""}, call()), std::invalid_argument);
  const auto other = service_of(sensors_);
  EXPECT_THROW(other->fire({part(1), {"range_m", "range_m"}, "", ""}, call()),
               std::invalid_argument);
  EXPECT_THROW(other->fire({part(1), {"weight"}, "", ""}, call()), std::invalid_argument);
  EXPECT_THROW(other->fire({part(1), {}, "hokuyo", ""}, call()), std::invalid_argument);
  EXPECT_TRUE(sent_.empty());
}

TEST_F(FiringService, FiresInTheWorldsOfAFolderByTheirNames) {
  const io::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "worlds");
  elements::write_model(folder / "worlds/flat", underbrush::test::flat_ground(60));
  elements::Model raised = underbrush::test::flat_ground(60);
  raised.origin.z() = 0.7;
  elements::write_model(folder / "worlds/raised", raised);
  elements::write_model(folder / "outside", raised);
  std::ofstream(folder / "worlds/note.txt") << "no world\n";
  std::filesystem::create_directory_symlink(folder / "outside", folder / "worlds/link");
  WorldOptions options;
  options.sensor = "velodyne-vlp16";
  OtherWorlds others(folder / "worlds", options);
  const auto service = service_of(sensors_, {}, &others);
  const auto described = [&](const std::string& world) {
    return service->describe(world, call().deadline).value();
  };
  EXPECT_EQ(described("raised").worlds, (std::vector<std::string>{"flat", "note.txt", "raised"}));
  EXPECT_TRUE(described("raised").actors.empty());
  EXPECT_EQ(described("").actors, std::vector<std::string>{"cart"});
  const auto fired = [&](const std::string& world) {
    sent_.clear();
    Firing f = part(3);
    f.actors.clear();
    EXPECT_TRUE(service->fire({f, {"range_m"}, "", world}, call()));
    return column(0);
  };
  const std::string own = fired("");
  pipeline::TracedWorld alone(raised);
  LiveSensors there(alone, {}, sensor::load("velodyne-vlp16"));
  Firing f = part(3);
  f.actors.clear();
  const BeamLog expected = there.fire(f);
  const std::string raised_ranges = fired("raised");
  ASSERT_EQ(raised_ranges.size(), 4 * expected.size());
  EXPECT_EQ(std::memcmp(raised_ranges.data(), expected.range_m.data(), raised_ranges.size()), 0);
  EXPECT_NE(fired("flat"), raised_ranges);
  EXPECT_EQ(fired("raised"), raised_ranges);
  EXPECT_EQ(fired(""), own);
  for (const char* name : {"link", "outside", "../outside", "."}) {
    EXPECT_THROW(described(name), std::invalid_argument) << name;
  }
  EXPECT_THROW(described("note.txt"), std::invalid_argument);
  EXPECT_THROW(service_of(sensors_)->describe("flat", call().deadline), std::invalid_argument);
  EXPECT_EQ(fired("flat"), fired("flat"));
}

// While a world is being opened, a call for another one ends with its deadline.
TEST_F(FiringService, WaitsForAWorldUntilTheDeadline) {
  const io::TemporaryFolder folder;
  std::ofstream large(folder / "large.obj");
  for (int k = 0; k < 100000; ++k) {
    large << "v " << k << " 0 0\nv " << k << " 1 0\nv " << k << " 0 1\nf -3 -2 -1\n";
  }
  large.close();
  WorldOptions options;
  options.sensor = "velodyne-vlp16";
  OtherWorlds others(folder.path(), options);
  const Deadline late = call().deadline;
  std::atomic<bool> opened = false;
  std::thread first([&] {
    EXPECT_TRUE(others.sensors("large.obj", late));
    opened = true;
  });
  bool ended = false;
  while (!opened && !ended) {
    try {
      ended = !others.sensors("none", std::chrono::system_clock::now());
    } catch (const std::invalid_argument&) {  // Nobody opens a world now.
    }
  }
  first.join();
  EXPECT_TRUE(ended);
}

TEST_F(FiringService, EndsWithItsDeadlineAndItsClient) {
  const auto service = service_of(sensors_, {1 << 20, 3600, 100});
  Call gone = call();
  gone.is_cancelled = [] { return true; };
  EXPECT_FALSE(service->fire({part(3), {}, "", ""}, gone));
  EXPECT_TRUE(sent_.empty());
  Call slow = call();
  slow.send = [&](const Part& p) {
    // Another client is answered while this one takes its time, until its own deadline.
    if (p.first_row > 0) return false;
    EXPECT_TRUE(service->fire({part(2), {}, "", ""}, call()));
    return false;
  };
  EXPECT_FALSE(service->fire({part(3), {}, "", ""}, slow));
  EXPECT_FALSE(sent_.empty());
}

}  // namespace
}  // namespace underbrush::live
