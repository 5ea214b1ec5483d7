#include "underbrush/perception/grid_file.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "clouds.hpp"
#include "io/temporary.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::perception {
namespace {

// Walls 10 m around the vehicle, a point for each degree, and grass on the way to the left.
MergedCloud courtyard(double time_s) {
  MergedCloud cloud = test::empty_cloud(time_s);
  for (int degree = 0; degree < 720; ++degree) {
    const double a = degree * M_PI / 360,
                 r = 10 / std::max(std::abs(std::cos(a)), std::abs(std::sin(a)));
    for (const double z : {0.5, 1.0, 1.5})
      test::add_point(cloud, {r * std::cos(a), r * std::sin(a), z});
  }
  return cloud;
}

TEST(FreeArea, EndsAtTheWallsOfACourtyard) {
  for (const double yaw : {0.0, 0.7, -2.0}) {
    OccupancyGrid grid;
    for (int cycle = 0; cycle < 5; ++cycle) grid.step(courtyard(cycle));
    Pose vehicle;
    vehicle.rotation = Eigen::AngleAxisd(yaw, Vec3::UnitZ());
    std::vector<Vec3> outline;
    find_free_area(grid, vehicle, {}, outline);
    ASSERT_EQ(outline.size(), 180u);
    for (size_t k = 0; k < outline.size(); ++k) {
      const double bearing = std::atan2(outline[k].y(), outline[k].x());
      const double expected = 2 * M_PI * double(k) / 180 + yaw;
      EXPECT_NEAR(std::remainder(bearing - expected, 2 * M_PI), 0, 1e-9);
      EXPECT_NEAR(outline[k].head<2>().cwiseAbs().maxCoeff(), 10, 0.3) << k;
    }
  }
}

TEST(FreeArea, NothingIsFreeBeyondTheVehicleWhereNothingWasSeen) {
  OccupancyGrid grid;
  grid.step(test::empty_cloud(0));
  std::vector<Vec3> outline;
  find_free_area(grid, {}, {}, outline);
  for (const Vec3& corner : outline) EXPECT_NEAR(corner.norm(), 3, 0.2);
}

// An upright vehicle frame has no bearings in the plane; the search must still end.
TEST(FreeArea, EndsForAVehicleThatStandsOnItsNose) {
  OccupancyGrid grid;
  grid.step(courtyard(0));
  Pose vehicle;
  vehicle.rotation = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY());
  std::vector<Vec3> outline;
  find_free_area(grid, vehicle, {}, outline);
  EXPECT_EQ(outline.size(), 180u);
}

TEST(GridFile, HoldsEveryCellOfEveryCycle) {
  const io::TemporaryFolder folder;
  const auto path = folder / "grid.json";
  GridOptions options;
  options.half_side_m = 20;
  OccupancyGrid grid(options);
  GridWriter writer(path, R"({"verb":"perceive"})", {});
  for (int cycle = 0; cycle < 3; ++cycle) {
    MergedCloud cloud = courtyard(cycle);
    cloud.world_from_vehicle.translation = {0.3 * cycle, 100, 0};
    grid.step(cloud);
    writer.write(grid, cloud.world_from_vehicle, cloud.time_s);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  writer.close();
  const auto j = nlohmann::json::parse(read_file(path));
  EXPECT_EQ(j["format"], "underbrush-occupancy-grids");
  EXPECT_EQ(j["provenance"]["verb"], "perceive");
  ASSERT_EQ(j["grids"].size(), 3u);
  const auto& last = j["grids"][2];
  EXPECT_EQ(last["time"], 2.0);
  const auto labels = cell_labels(grid, FreeAreaOptions{}.free_probability);
  size_t at = 0;
  for (size_t k = 0; k < last["runs"].size(); k += 2) {
    for (size_t n = last["runs"][k + 1]; n > 0; --n) {
      ASSERT_LT(at, labels.size());
      ASSERT_EQ(size_t(labels[at++]), last["runs"][k].get<size_t>());
    }
  }
  EXPECT_EQ(at, last["columns"].get<size_t>() * last["rows"].get<size_t>());
  // The wall ahead is solid, the yard is free, and what lies behind the wall is not known.
  const double cell = last["cell"], x0 = last["corner"][0], y0 = last["corner"][1];
  const auto label_at = [&](double x, double y) {
    return labels[size_t((y - y0) / cell) * grid.columns() + size_t((x - x0) / cell)];
  };
  EXPECT_EQ(label_at(0.6 + 10.02, 100.02), CellLabel::kSolid);
  EXPECT_EQ(label_at(0.6 + 5, 100.02), CellLabel::kFree);
  EXPECT_EQ(label_at(0.6 + 15, 100.02), CellLabel::kUnknown);
}

TEST(GridFile, ThePictureHasTheVehiclesFrontToTheRight) {
  OccupancyGrid grid;
  MergedCloud cloud = test::empty_cloud(0);
  for (int k = 0; k < 5; ++k) test::add_point(cloud, {10.1, 5.1, 1});
  grid.step(cloud);
  const io::Image image = picture_of_grid(grid, 0.6);
  ASSERT_EQ(image.width, 400);
  const auto pixel = [&](double x, double y) {
    const size_t column = size_t((x + 40) / 0.2), row = 399 - size_t((y + 40) / 0.2);
    return image.rgb[3 * (row * 400 + column)];
  };
  EXPECT_EQ(pixel(10.1, 5.1), 0);     // solid
  EXPECT_EQ(pixel(5.1, 2.55), 255);   // free
  EXPECT_EQ(pixel(10.1, -5.1), 190);  // unknown
}

}  // namespace
}  // namespace underbrush::perception
