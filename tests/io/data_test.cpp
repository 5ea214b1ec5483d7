// Tests on real files, whose README files state what must come out.
#include "data.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "temporary.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::io {
namespace {

PointScan first_scan(const std::filesystem::path& path) { return open_input(path).scans->read(0); }

TEST(RealData, RellisKeepsMissesAndFields) {
  UNDERBRUSH_NEEDS_DATA("rellis_000104");
  const auto folder = test::data_folder() / "rellis_000104";
  const PointScan ply = first_scan(folder / "frame000104-1581624663_170.ply");
  ASSERT_EQ(ply.size(), 131072u);
  EXPECT_EQ(std::count(ply.point.begin(), ply.point.end(), Vec3f::Zero()), 53364);
  EXPECT_EQ(*std::max_element(ply.ring.begin(), ply.ring.end()), 63);
  for (const char* name : {"reflectivity", "noise", "range"}) EXPECT_TRUE(ply.extra.count(name));
  const auto [first, last] = std::minmax_element(ply.time_s.begin(), ply.time_s.end());
  EXPECT_NEAR(*last - *first, 0.1, 0.001);
  const auto& range = std::get<std::vector<uint32_t>>(ply.extra.at("range"));
  for (size_t i = 0; i < ply.size(); i += 1009) {
    EXPECT_NEAR(ply.point[i].norm(), range[i] * 1e-3, 0.05);
  }
  const PointScan bin = first_scan(folder / "000104.bin");
  EXPECT_EQ(bin.size(), ply.size());
}

TEST(RealData, MarvArrayIsOrganisedWithMisses) {
  UNDERBRUSH_NEEDS_DATA("marv_forest");
  const PointScan scan =
      first_scan(test::data_folder() / "marv_forest" / "1727353472_601360559.npz");
  ASSERT_EQ(scan.size(), 131072u);
  EXPECT_EQ(std::count_if(scan.point.begin(), scan.point.end(),
                          [](const Vec3f& p) { return std::isnan(p.x()); }),
            39172);
  EXPECT_TRUE(scan.extra.count("ambient"));
}

TEST(RealData, SemanticKittiLabels) {
  UNDERBRUSH_NEEDS_DATA("kitti00_labelled");
  const auto from = test::data_folder() / "kitti00_labelled";
  const TemporaryFolder folder;
  for (const char* name : {"velodyne", "labels"}) {
    std::filesystem::create_directories(folder / name);
  }
  std::filesystem::copy(from / "kitti00_000000.bin", folder / "velodyne/000000.bin");
  std::filesystem::copy(from / "kitti00_000000.label", folder / "labels/000000.label");
  put_bytes(folder / "calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  put_bytes(folder / "poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const PointScan scan = first_scan(folder.path());
  const auto& label = std::get<std::vector<uint16_t>>(scan.extra.at("class"));
  EXPECT_EQ(std::count(label.begin(), label.end(), 70), 27123);
  EXPECT_EQ(std::count(label.begin(), label.end(), 71), 1192);
}

}  // namespace
}  // namespace underbrush::io
