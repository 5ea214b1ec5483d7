#include "underbrush/core/names.hpp"

#include <gtest/gtest.h>

namespace underbrush {
namespace {

TEST(NearestName, IsTheOneOfFewestEditsOrNone) {
  const std::vector<std::string> known = {"velodyne-vlp16", "velodyne-vlp32c", "ouster-os1-64"};
  EXPECT_EQ(nearest_name("velodyne-vpl16", known), "velodyne-vlp16");
  EXPECT_EQ(nearest_name("vlp32c", known), "velodyne-vlp32c");
  EXPECT_EQ(nearest_name("vlp61", known), "velodyne-vlp16");
  EXPECT_EQ(nearest_name("riegl", known), "");
  EXPECT_EQ(nearest_name("ouster-os1", known), "ouster-os1-64");
  EXPECT_EQ(nearest_name("velodyne-vlp32", known), "velodyne-vlp32c");
  EXPECT_EQ(nearest_name("", known), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace underbrush
