#include "underbrush/library/library.hpp"

#include <gtest/gtest.h>

#include <set>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::library {
namespace {

using elements::Class;
using primitives::Primitive;

/// Sets of two logs: trees of rising height at places 20 m apart, and shrubs.
class Library : public testing::Test {
 protected:
  Library() {
    write("a", 0, "hdl-64e");
    write("b", 5, "vlp-16");
  }
  /// Writes a set of eight primitives, numbered from `first`.
  void write(const std::string& name, int first, const std::string& sensor) const {
    std::vector<Primitive> all;
    for (int k = first; k < first + 8; ++k) {
      Primitive p;
      p.label = k % 4 ? Class::kSmallTree : Class::kLowShrub;
      p.box = {Vec3(-1, -0.5, 0), Vec3(1, 0.5, 1 + 0.5 * k)};
      p.model.ellipsoids.emplace_back();
      p.model.ellipsoids[0].mean = Vec3f(float(k), float(first), 0);  // Other elements in each set.
      p.model.sensor = sensor;
      p.source.label = p.label;
      p.source.position = Vec3(20 * k, 0, 0);
      p.source.box = p.box;
      p.source.points = size_t(100 + first);
      if (k == first + 1) p.plants.push_back({"oak", Vec3(1, 2, 3), 0.1, 2, 0.3, Vec3(4, 5, 6)});
      all.push_back(p);
    }
    primitives::write_primitives(folder / name, all, 2, R"({"command": "extract )" + name + "\"}");
  }
  std::vector<std::filesystem::path> both() const { return {folder / "a", folder / "b"}; }
  primitives::PrimitiveSet written(const Merged& m) const {
    primitives::write_primitives(folder / "library", m.primitives, m.cell_m, "{}", m.origins);
    return primitives::read_primitive_set(folder / "library");
  }
  io::TemporaryFolder folder;
};

TEST_F(Library, KeepsWhereEachPrimitiveComesFrom) {
  Options o;
  o.of_site = {"creek", "meadow"};
  o.of_license = {"CC-BY-4.0"};
  o.of_season = {"summer", "winter"};
  const Merged merged = merge_sets(both(), o);
  EXPECT_EQ(merged.primitives.size(), 16u);
  EXPECT_EQ(merged.without_license, 0u);
  const primitives::PrimitiveSet set = written(merged);
  ASSERT_EQ(set.origins.size(), 2u);
  EXPECT_EQ(set.origins[0].set, "a");
  EXPECT_EQ(set.origins[1].site, "meadow");
  EXPECT_EQ(set.origins[0].sensor, "hdl-64e");
  EXPECT_EQ(set.origins[1].license, "CC-BY-4.0");
  EXPECT_NE(set.origins[1].provenance.find("extract b"), std::string::npos);
  size_t plants = 0;
  for (size_t k = 0; k < set.entries.size(); ++k) {
    const Primitive p = primitives::read_whole_primitive(set, k);
    const bool of_b = p.model.ellipsoids.at(0).mean.y() == 5;
    EXPECT_EQ(p.origin, of_b ? 1u : 0u);
    EXPECT_EQ(p.model.sensor, of_b ? "vlp-16" : "hdl-64e");
    EXPECT_NE(p.model.provenance.find(of_b ? "extract b" : "extract a"), std::string::npos);
    EXPECT_EQ(p.source.position.x(), 20 * double(p.model.ellipsoids[0].mean.x()));
    EXPECT_EQ(p.source.points, of_b ? 105u : 100u);
    plants += p.plants.size();
  }
  EXPECT_EQ(plants, 2u);
  // A library that is merged again keeps its origins.
  const std::filesystem::path again[] = {folder / "library"};
  const Merged same = merge_sets(again, {});
  ASSERT_EQ(same.origins.size(), 2u);
  EXPECT_EQ(same.origins[1].site, "meadow");
  EXPECT_EQ(same.primitives.size(), 16u);
}

TEST_F(Library, FindsByClassSizeAndOrigin) {
  Options o;
  o.of_season = {"summer", "winter"};
  const primitives::PrimitiveSet set = written(merge_sets(both(), o));
  Options search;
  search.classes = {"tree"};
  search.season = "winter";
  search.least_height_m = 4;
  search.most_height_m = 6;
  size_t expected = 0;
  for (const primitives::PrimitiveEntry& e : set.entries) {
    expected +=
        e.label == Class::kSmallTree && e.origin == 1 && e.box.max.z() >= 4 && e.box.max.z() <= 6;
  }
  const std::vector<Found> found = find_primitives(set, search);
  EXPECT_EQ(found.size(), expected);
  EXPECT_GT(expected, 2u);
  for (const Found& f : found) {
    EXPECT_EQ(set.entries.at(f.entry).name, f.name);
    EXPECT_EQ(f.origin.season, "winter");
  }
  const std::filesystem::path library[] = {folder / "library"};
  const Merged cut = merge_sets(library, search);  // A search cuts a part out.
  EXPECT_EQ(cut.primitives.size(), expected);
  EXPECT_EQ(cut.not_wanted, 16 - expected);
  search.sensor = "hdl-64e";
  EXPECT_TRUE(find_primitives(set, search).empty());
  search.classes = {"trees"};
  EXPECT_THROW(find_primitives(set, search), std::invalid_argument);
}

TEST_F(Library, FindsDuplicates) {
  const std::filesystem::path twice[] = {folder / "a", folder / "a"};
  const Merged same = merge_sets(twice, {});
  EXPECT_EQ(same.duplicates, 8u);
  EXPECT_EQ(same.primitives.size(), 8u);
  Options keep;
  keep.keep_duplicates = true;
  EXPECT_EQ(merge_sets(twice, keep).primitives.size(), 16u);
  // The plants 5, 6 and 7 are in both logs; 6 is made of a mesh in b, so it stood nowhere.
  EXPECT_EQ(merge_sets(both(), {}).duplicates, 0u);  // Nobody says that the sites are the same.
  Options one_site;
  one_site.of_site = {"creek"};
  const Merged merged = merge_sets(both(), one_site);
  EXPECT_EQ(merged.duplicates, 2u);
  for (const Primitive& p : merged.primitives) {
    const double place = p.source.position.x() / 20;
    if (place == 5 || place == 7) {
      EXPECT_EQ(p.source.points, 105u);  // That of more points stays.
    }
  }
}

TEST_F(Library, RefusesWhatDoesNotFit) {
  Options o;
  o.of_site = {"creek", "meadow", "wood"};
  EXPECT_THROW(merge_sets(both(), o), std::invalid_argument);
  EXPECT_THROW(merge_sets({}, {}), std::invalid_argument);
  primitives::write_primitives(folder / "c", {}, 1, "{}");
  const std::filesystem::path other[] = {folder / "a", folder / "c"};
  EXPECT_THROW(merge_sets(other, {}), FormatError);
}

}  // namespace
}  // namespace underbrush::library
