#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/trace/world.hpp"
#include "underbrush/worlds/read_world.hpp"
#include "underbrush/worlds/voxel_file.hpp"

namespace underbrush::worlds {
namespace {

class Voxels : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& text, const std::string& name = "a.vox") {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  io::TemporaryFolder folder;
};

std::string grid(int n, double side, const std::string& density,
                 const std::string& low = "500000 4500000 100") {
  char text[300];
  const double x = std::stod(low);
  std::snprintf(text, sizeof text,
                "VOXEL SPACE\n#min_corner: %s\n#max_corner: %.6f %.6f %.6f\n#split: %d %d %d\n"
                "#res: %g #lad_type:Spherical\ni j k PadBVTotal angleMean\n",
                low.c_str(), x + n * side, 4500000 + n * side, 100 + n * side, n, n, n, side);
  std::string out = text;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int k = 0; k < n; ++k) {
        out += std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(k) + " " +
               density + " 45\n";
      }
    }
  }
  return out;
}

// Law: through a homogeneous medium of plant area density PAD, the share exp(−PAD L / 2) of the
// beams passes a way L (Beer and Lambert, with leaves of all directions alike).
TEST_F(Voxels, AHomogeneousMediumTransmitsByBeerAndLambert) {
  constexpr int kCells = 16, kBeams = 40000;
  constexpr double kSide = 0.5;
  Stream random(5);
  for (const double density : {0.1, 0.4, 1.0}) {
    const World world = read_world(write(grid(kCells, kSide, std::to_string(density))));
    const trace::World traced(world.scene);
    const Vec3 middle = Vec3(500000, 4500000, 100) + 0.5 * kCells * kSide * Vec3::Ones();
    for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0.2, 0.1, 1), Vec3(0.3, 0.3, -0.9)}) {
      const Vec3 d = direction.normalized();
      const double way = kCells * kSide / d.cwiseAbs().maxCoeff();
      int passed = 0;
      for (int k = 0; k < kBeams; ++k) {
        const double x = random.uniform(-0.5, 0.5), y = random.uniform(-0.5, 0.5);
        const Vec3 at = middle + Vec3(x, y, random.uniform(-0.5, 0.5));
        passed += traced.nearest_accepted({at - 30 * d, d}, mix64(uint64_t(k)), {0, 60}).none();
      }
      const double share = double(passed) / kBeams, law = std::exp(-0.5 * density * way);
      // Four standard deviations, and what the mean over rays of unlike depth may differ.
      const double bound = 4 * std::sqrt(law * (1 - law) / kBeams) + 2e-3 * law * density * way;
      EXPECT_NEAR(share, law, bound) << density << " along " << d.transpose();
    }
  }
}

// Touching voxels multiply, as HELIOS++ 2.2 does not.
TEST_F(Voxels, TwoHalvesTransmitTheSquareOfOne) {
  const VoxelFile v = read_voxels(write(grid(4, 0.5, "0.7")));
  const auto all = ellipsoids_of(v, v.low);
  ASSERT_EQ(all.size(), 64u);
  // Σ κ (2π)^(3/2) |Σ|^(1/2), cut at τ, is the extinction G · PAD times the volume.
  double extinction = 0;
  for (const auto& e : all) {
    extinction +=
        e.density_per_m * std::pow(2 * M_PI, 1.5) * 0.25 * 0.25 * 0.25 * (1 - std::exp(-4.5));
  }
  EXPECT_NEAR(extinction, 0.5 * 0.7 * 8, 1e-5);
}

TEST_F(Voxels, KeepsPlacesAndCountsWhatItLeavesOut) {
  std::string text = grid(2, 1, "0.5");
  text += "0 0 0 nan 1\n0 0 1 -1 1\n1 1 1 inf 0\n1 1 1 0 0\n";
  const World w = read_world(write(text));
  EXPECT_EQ(w.report.voxels, 8u);
  EXPECT_EQ(w.report.left_out.at("voxels without a plant area density"), 2u);
  EXPECT_EQ(w.report.left_out.at("voxels whose plant area density is negative or beyond 1e6"), 1u);
  const elements::Instance& placed = w.scene.instances.at(1);
  const Vec3 first = placed.world_from_model.translation +
                     w.scene.models.at(placed.model).ellipsoids.at(0).mean.cast<double>();
  EXPECT_LT((first - Vec3(500000.5, 4500000.5, 100.5)).norm(), 1e-9);
  EXPECT_EQ(elements::class_name(w.info, w.info.labels.at(1)), "leaf");
  EXPECT_EQ(cubes_of(read_voxels(folder / "a.vox")).triangles.size(), 12 * 9u);
}

TEST_F(Voxels, RefusesWhatIsDamaged) {
  const std::string good = grid(2, 1, "0.5");
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"VOXEL SPACE", "VOXEL"},
                                 {"#split: 2 2 2", "#split: 2 2"},
                                 {"#split: 2 2 2", "#split: 0 2 2"},
                                 {"#split: 2 2 2", "#split: 99999999 2 2"},
                                 {"#split", "#splat"},
                                 {"#min_corner: 500000", "#min_corner: nan"},
                                 {"#max_corner: 500002", "#max_corner: 400000"},
                                 {"i j k", "i j l"},
                                 {"PadBVTotal", "Pod"},
                                 {"0 0 0 0.5", "0 0 2 0.5"},
                                 {"0 0 0 0.5", "0 0 0.5 1"},
                                 {"0 0 0 0.5 45", "0 0"},
                                 {"0 0 0 0.5", "x 0 0 0.5"}}) {
    std::string bad = good;
    ASSERT_NE(bad.find(from), std::string::npos) << from;
    bad.replace(bad.find(from), from.size(), to);
    EXPECT_THROW(read_voxels(write(bad)), FormatError) << from << " -> " << to;
  }
  EXPECT_THROW(read_voxels(write("")), FormatError);
  EXPECT_THROW(read_voxels(write(good.substr(0, 60))), FormatError);
}

}  // namespace
}  // namespace underbrush::worlds
