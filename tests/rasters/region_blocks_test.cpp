// The cells and voxels of a world of regions are those of the world in memory, to the bit.
#include "underbrush/rasters/region_blocks.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "io/temporary.hpp"
#include "region_worlds.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/rasters/rasters.hpp"
#include "underbrush/regions/cut.hpp"

namespace underbrush::rasters {
namespace {

void expect_same(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(float) * a.size()), 0);
}

TEST(RegionBlocks, HaveTheCellsAndVoxelsOfTheWhole) {
  const io::TemporaryFolder folder;
  for (const bool is_scene : {false, true}) {
    const pipeline::World whole =
        is_scene ? test::world_of_scene() : test::world_of(test::whole_model());
    regions::write_world(folder / "world", whole.scene, whole.info, test::kSide, "{}");
    RasterOptions options;
    options.canopy = {1.5, 2, 1};
    const Canopy expected = canopy_of(
        whole.scene, pipeline::TracedWorld(whole.scene, whole.info).still(), options.canopy);
    for (const char* memory : {"2GiB", "600KiB", "250KiB"}) {
      options.memory = memory;
      const Canopy found = canopy_of_world(folder / "world", options);
      EXPECT_EQ(found.low, expected.low);
      ASSERT_EQ(found.size, expected.size);
      expect_same(found.ground, expected.ground);
      expect_same(found.height, expected.height);
      expect_same(found.cover, expected.cover);
      expect_same(found.gap, expected.gap);
      expect_same(found.area_density, expected.area_density);
    }
    options.memory = "30KiB";
    EXPECT_THROW(canopy_of_world(folder / "world", options), FormatError);
  }
}

}  // namespace
}  // namespace underbrush::rasters
