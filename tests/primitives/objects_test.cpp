#include "underbrush/primitives/objects.hpp"

#include <lzma.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>

#include "data.hpp"
#include "primitives/sites.hpp"
#include "underbrush/metrics/instances.hpp"

namespace underbrush::primitives {
namespace {

using elements::Class;
using elements::ClassKind;
using test::add_cone;

struct Found {
  std::vector<uint32_t> object;
  std::vector<FoundObject> objects;
};

Found find(const std::vector<Vec3f>& points, const ObjectOptions& options = {}) {
  ObjectFinder finder(options);
  finder.add(points);
  finder.find();
  Found out;
  out.objects = finder.objects();
  for (const Vec3f& p : points) out.object.push_back(finder.object_of(p));
  return out;
}

// Makes a grid of cone-shaped trees of rising height. `truth` gets the number of the cone of each
// point.
std::vector<Vec3f> trees(std::vector<uint32_t>& truth, uint64_t seed) {
  Stream random(seed);
  std::vector<Vec3f> points;
  for (uint32_t k = 0; k < 9; ++k) {
    add_cone(points, 7.0 * (k % 3), 7.0 * (k / 3), 2, 0.2, 4 + k, 6000, random);
    truth.resize(points.size(), k + 1);
  }
  return points;
}

metrics::InstanceScore score(const std::vector<uint32_t>& found,
                             const std::vector<uint32_t>& truth) {
  metrics::InstanceCounter counter;
  for (size_t i = 0; i < found.size(); ++i) counter.add(found[i], truth[i]);
  return counter.score(10);
}

TEST(Objects, TreesThatStandApartAreFoundEach) {
  std::vector<uint32_t> truth;
  const Found found = find(trees(truth, 1));
  const metrics::InstanceScore s = score(found.object, truth);
  EXPECT_EQ(s.found, 9u);
  EXPECT_EQ(s.matched, 9u);
  EXPECT_GT(s.mean_iou, 0.98);
}

TEST(Objects, NeitherOrderNorCutsOfThePointsMatter) {
  std::vector<uint32_t> truth;
  const std::vector<Vec3f> points = trees(truth, 2);
  const Found once = find(points);
  std::vector<Vec3f> back(points.rbegin(), points.rend());
  ObjectFinder finder;
  for (size_t at = 0; at < back.size(); at += 777) {
    finder.add({back.data() + at, std::min<size_t>(777, back.size() - at)});
  }
  finder.find();
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(finder.object_of(points[i]), once.object[i]) << i;
  }
}

TEST(Objects, MoveWithThePoints) {
  std::vector<uint32_t> truth;
  std::vector<Vec3f> points = trees(truth, 3);
  const Found here = find(points);
  for (Vec3f& p : points) p += Vec3f(-512, 1024, 0);  // whole columns, exact in float
  for (Vec3f& p : points) p = (p * 1024).array().round() / 1024;
  const Found there = find(points);
  EXPECT_EQ(here.objects.size(), there.objects.size());
  EXPECT_GT(score(there.object, here.object).mean_iou, 0.99);
}

TEST(Objects, AreClassedByTheirSizes) {
  const std::array<std::pair<double, Class>, 7> kinds{{{0.4, Class::kLowShrub},
                                                       {0.9, Class::kSmallShrub},
                                                       {1.7, Class::kMediumShrub},
                                                       {2.7, Class::kLargeShrub},
                                                       {5, Class::kSmallTree},
                                                       {8, Class::kMediumTree},
                                                       {14, Class::kLargeTree}}};
  Stream random(4);
  for (const auto& [height, label] : kinds) {
    std::vector<Vec3f> points;
    add_cone(points, 3, 5, 1.2, 0.05, height, 4000, random);
    const Found found = find(points);
    ASSERT_EQ(found.objects.size(), 1u) << height;
    EXPECT_EQ(found.objects[0].label, label) << height;
    float top = 0;
    for (const Vec3f& p : points) top = std::max(top, p.z());
    EXPECT_FLOAT_EQ(float(found.objects[0].height_m), top);
  }
  ObjectOptions options;
  options.sizes.tree_m = 2;
  options.sizes.medium_tree_m = 2.5;
  std::vector<Vec3f> points;
  add_cone(points, 3, 5, 1.2, 0.05, 2.7, 4000, random);
  EXPECT_EQ(find(points, options).objects.at(0).label, Class::kMediumTree);
}

TEST(Objects, ALongRowOfShrubsIsAPatch) {
  Stream random(5);
  std::vector<Vec3f> points;
  for (int k = 0; k < 12; ++k) add_cone(points, k, 0.2 * k, 1, 0.05, 1.5, 1500, random);
  const Found row = find(points);
  ASSERT_EQ(row.objects.size(), 1u);
  EXPECT_EQ(row.objects[0].label, Class::kMediumShrubPatch);
  EXPECT_NEAR(row.objects[0].side_m, 13, 0.8);
}

TEST(Objects, AShrubUnderACrownIsNotTheTree) {
  Stream random(6);
  std::vector<Vec3f> points;
  add_cone(points, 0, 0, 3, 4, 10, 20000, random);   // crown
  add_cone(points, 0, 0, 0.15, 0, 6, 1500, random);  // trunk
  const size_t tree = points.size();
  add_cone(points, 1.9, 0, 0.9, 0.05, 1.2, 3000, random);  // a shrub beneath the crown
  const Found found = find(points);
  ASSERT_EQ(found.objects.size(), 2u);
  size_t wrong = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const Class label = found.objects.at(found.object[i] - 1).label;
    wrong += (elements::kind_of(label) == ClassKind::kTree) != (i < tree);
  }
  EXPECT_LT(double(wrong), 0.03 * double(points.size()));
}

TEST(Objects, BadPointsAreNoObject) {
  const std::vector<Vec3f> points(50, Vec3f(NAN, 1, 1));
  const Found found = find(points);
  EXPECT_TRUE(found.objects.empty());
  EXPECT_EQ(found.object[0], 0u);
  EXPECT_EQ(find({}).objects.size(), 0u);
  ObjectOptions bad;
  bad.radius_a_m = 0;
  EXPECT_THROW(ObjectFinder{bad}, std::invalid_argument);
  bad = {};
  bad.sizes.medium_tree_m = 20;
  EXPECT_THROW(ObjectFinder{bad}, std::invalid_argument);
}

std::string unpacked(const std::filesystem::path& path) {
  const std::string packed = test::read_file(path);
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_stream_decoder(&stream, UINT64_MAX, 0) != LZMA_OK) return {};
  std::string out(1 << 22, '\0');
  stream.next_in = reinterpret_cast<const uint8_t*>(packed.data());
  stream.avail_in = packed.size();
  stream.next_out = reinterpret_cast<uint8_t*>(out.data());
  stream.avail_out = out.size();
  const lzma_ret done = lzma_code(&stream, LZMA_FINISH);
  out.resize(done == LZMA_STREAM_END ? stream.total_out : 0);
  lzma_end(&stream);
  return out;
}

// The cloud is airborne and its heights are normalised; the authors of lidR numbered the trees.
TEST(Objects, MatchTheTreesOfMixedConifer) {
  UNDERBRUSH_NEEDS_DATA("trees_laz/lidr_MixedConifer.ply.xz");
  const std::string ply = unpacked(test::data_folder() / "trees_laz/lidr_MixedConifer.ply.xz");
  const size_t begin = ply.find("end_header\n") + 11;
  constexpr size_t kRow = 3 * 8 + 4 + 8 + 4 + 4, kPoints = 37657;
  ASSERT_EQ(ply.size() - begin, kRow * kPoints);
  std::vector<Vec3f> points;
  std::vector<uint32_t> truth;
  for (size_t i = 0; i < kPoints; ++i) {
    double xyz[3];
    int32_t id;
    std::memcpy(xyz, ply.data() + begin + i * kRow, sizeof xyz);
    std::memcpy(&id, ply.data() + begin + (i + 1) * kRow - 4, 4);
    if (xyz[2] <= 0.5) continue;
    points.emplace_back(float(xyz[0] - 481260), float(xyz[1] - 3812921), float(xyz[2]));
    truth.push_back(id > 0 ? uint32_t(id) : 0);
  }
  const Found found = find(points);
  std::vector<uint32_t> tree = found.object;
  for (uint32_t& t : tree) {
    if (t && elements::kind_of(found.objects[t - 1].label) != ClassKind::kTree) t = 0;
  }
  const metrics::InstanceScore s = score(tree, truth);
  RecordProperty("precision", std::to_string(s.precision()));
  RecordProperty("recall", std::to_string(s.recall()));
  EXPECT_GT(s.precision(), 0.75);
  EXPECT_GT(s.recall(), 0.75);
}

}  // namespace
}  // namespace underbrush::primitives
