// Edits of the primitives of a set: laws, and lists that cannot be applied.
#include "underbrush/library/edits.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/library/library.hpp"

namespace underbrush::library {
namespace {

namespace fs = std::filesystem;
using elements::Class;
using primitives::Primitive;
using primitives::PrimitiveSet;

/// A library of two logs: trees, shrubs and a cell of a patch, each with an ellipsoid of its class.
class Edits : public testing::Test {
 protected:
  Edits() {
    for (int log = 0; log < 2; ++log) {
      std::vector<Primitive> all;
      for (int k = 0; k < 6; ++k) {
        Primitive p;
        p.label = k < 3 ? Class::kLargeShrub : k < 5 ? Class::kMediumTree : Class::kLowShrubPatch;
        p.box = {Vec3(-1, -0.5, 0), Vec3(1, 0.5, 2 + k)};
        p.model.ellipsoids.resize(2);
        p.model.ellipsoids[0].mean = Vec3f(float(k), float(log), 0);
        p.model.ellipsoids[0].label = uint32_t(p.label);
        p.model.ellipsoids[1].label = uint32_t(Class::kGrass);
        p.source.label = p.label;
        p.source.position = Vec3(20 * k, 0, 0);
        p.source.box = p.box;
        p.source.points = size_t(100 + log);
        all.push_back(p);
      }
      const fs::path set = folder / (log ? "b" : "a");
      primitives::write_primitives(set, all, 2, R"({"command": "extract"})");
    }
    Options o;
    o.of_site = {"creek", "meadow"};
    o.of_license = {"CC-BY-4.0", "MIT"};
    const fs::path both[] = {folder / "a", folder / "b"};
    write("library", merge_sets(both, o));
  }

  void write(const std::string& name, const Merged& m) const {
    primitives::write_primitives(folder / name, m.primitives, m.cell_m, "{}", m.origins);
  }
  /// Merges a set of the folder with a list of edits.
  Merged merged(const std::string& set, const std::string& edits, Options o = {}) const {
    o.edits = (folder / "edits.json").string();
    std::ofstream(o.edits) << R"({"format": "underbrush-primitive-edits", "version": 1, "edits": [)"
                           << edits << "]}";
    const fs::path sets[] = {folder / set};
    return merge_sets(sets, o);
  }
  PrimitiveSet read(const std::string& name) const {
    return primitives::read_primitive_set(folder / name);
  }
  std::map<std::string, std::string> files_of(const std::string& name) const {
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder / name)) {
      if (entry.is_directory()) continue;
      out[entry.path().lexically_relative(folder / name).string()] = read_file(entry.path());
    }
    return out;
  }
  io::TemporaryFolder folder;
};

constexpr const char* kMany = R"(
  {"primitive": "large_shrub/0002", "remove": true},
  {"primitive": "large_shrub/0003", "class": "small_tree", "name": "Ölbaum"},
  {"primitive": "medium_tree/0001", "name": "oak by the creek", "comment": "mine"},
  {"primitive": "low_shrub_patch/0001", "class": "small_shrub_patch"})";

TEST_F(Edits, NoneChangeNothing) {
  const fs::path sets[] = {folder / "library"};
  write("plain", merge_sets(sets, {}));
  write("edited", merged("library", ""));
  EXPECT_EQ(files_of("edited"), files_of("plain"));
  write("edited", merged("library", kMany));
  EXPECT_NE(files_of("edited"), files_of("plain"));
}

TEST_F(Edits, ThrowOutRelabelAndName) {
  const Merged m = merged("library", kMany);
  EXPECT_EQ(m.edits.thrown_out, 1u);
  EXPECT_EQ(m.edits.relabelled, 2u);
  EXPECT_EQ(m.edits.named, 2u);
  write("edited", m);
  const PrimitiveSet before = read("library"), after = read("edited");
  ASSERT_EQ(after.entries.size(), before.entries.size() - 1);
  std::map<std::string, size_t> folders;
  for (size_t k = 0; k < after.entries.size(); ++k) folders[after.entries[k].name] = k;
  EXPECT_EQ(folders.count("large_shrub/0005"), 0u);
  ASSERT_EQ(folders.count("small_tree/0001"), 1u);  // In the folder of its new class.
  const size_t olive = folders.at("small_tree/0001");
  EXPECT_EQ(after.entries[olive].given_name, "Ölbaum");
  const Primitive p = primitives::read_whole_primitive(after, olive);
  EXPECT_EQ(p.model.ellipsoids.at(0).mean, Vec3f(2, 0, 0));  // The third shrub of the first log.
  EXPECT_EQ(p.model.ellipsoids[0].label, uint32_t(Class::kSmallTree));
  EXPECT_EQ(p.model.ellipsoids[1].label, uint32_t(Class::kGrass));  // It was of another class.
  EXPECT_EQ(p.source.label, Class::kLargeShrub);  // As it was measured in the log.
  EXPECT_EQ(after.entries[folders.at("medium_tree/0001")].given_name, "oak by the creek");
  EXPECT_EQ(folders.count("small_shrub_patch/0001"), 1u);
  // Every primitive that is left has the elements, the place and the licence that it had.
  std::map<std::pair<float, float>, std::string> licences;
  for (size_t k = 0; k < before.entries.size(); ++k) {
    const Vec3f mean = primitives::read_primitive(before, k).ellipsoids[0].mean;
    licences[{mean.x(), mean.y()}] = before.origins.at(before.entries[k].origin).license;
  }
  for (size_t k = 0; k < after.entries.size(); ++k) {
    const Primitive q = primitives::read_whole_primitive(after, k);
    const Vec3f mean = q.model.ellipsoids[0].mean;
    EXPECT_EQ(after.origins.at(q.origin).license, (licences[{mean.x(), mean.y()}]));
    EXPECT_EQ(q.source.position.x(), 20 * double(mean.x()));
  }
}

TEST_F(Edits, NamesAndOriginsOutliveFurtherMerges) {
  write("edited", merged("library", kMany));
  const fs::path sets[] = {folder / "edited"};
  write("again", merge_sets(sets, {}));
  const PrimitiveSet edited = read("edited"), again = read("again");
  ASSERT_EQ(again.entries.size(), edited.entries.size());
  for (size_t k = 0; k < edited.entries.size(); ++k) {
    EXPECT_EQ(again.entries[k].given_name, edited.entries[k].given_name);
    EXPECT_EQ(again.entries[k].label, edited.entries[k].label);
    EXPECT_EQ(again.origins.at(again.entries[k].origin).license,
              edited.origins.at(edited.entries[k].origin).license);
  }
  Options search;
  search.name = "creek";
  const std::vector<Found> found = find_primitives(again, search);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].given_name, "oak by the creek");
  // A name is taken away by an empty one, and a class can be given back.
  write("back",
        merged("again", R"({"primitive": "small_tree/0001", "class": "large_shrub", "name": ""})"));
  const PrimitiveSet back = read("back");
  EXPECT_TRUE(std::ranges::none_of(back.entries, [](const auto& e) {
    return e.name == "small_tree/0001" || e.given_name == "Ölbaum";
  }));
  for (size_t k = 0; k < back.entries.size(); ++k) {
    const elements::Model model = primitives::read_primitive(back, k);
    EXPECT_EQ(model.ellipsoids[0].label, uint32_t(back.entries[k].label));
  }
}

TEST_F(Edits, ADuplicateThatStaysTakesTheNameOver) {
  write("named", merged("a", R"({"primitive": "medium_tree/0001", "name": "oak"})"));
  Options one_site;  // The same plants in both sets, those of b with more points.
  one_site.of_site = {"creek"};
  const fs::path sets[] = {folder / "named", folder / "b"},
                 turned[] = {folder / "b", folder / "named"};
  for (const auto& order : {std::span(sets), std::span(turned)}) {
    const Merged m = merge_sets(order, one_site);
    ASSERT_EQ(m.primitives.size(), 6u);
    for (const Primitive& p : m.primitives) {
      EXPECT_EQ(p.source.points, 101u);
      const bool is_oak = p.label == Class::kMediumTree && p.model.ellipsoids[0].mean.x() == 3;
      EXPECT_EQ(p.given_name, is_oak ? "oak" : "");
    }
  }
}

TEST_F(Edits, GiveTheSameBitsForAnyThreads) {
  set_threads(1);
  write("one", merged("library", kMany));
  set_threads(4);
  write("four", merged("library", kMany));
  set_threads(0);
  EXPECT_EQ(files_of("one"), files_of("four"));
}

TEST_F(Edits, ThatCannotBeNameTheirPlace) {
  const std::string first = R"({"primitive": "large_shrub/0001", "name": "a"}, )";
  const std::pair<const char*, const char*> cases[] = {
      {R"({"primitive": "large_shrub/0007", "remove": true})", "edits[1].primitive"},
      {R"({"primitive": "large_shrub/0001", "remove": true})", "edits[1].primitive"},  // Twice.
      {R"({"primitive": 3, "remove": true})", "edits[1].primitive"},
      {R"({"primitive": "large_shrub/0002"})", "edits[1]"},
      {R"({"primitive": "large_shrub/0002", "remove": false})", "edits[1].remove"},
      {R"({"primitive": "large_shrub/0002", "remove": true, "name": "b"})", "edits[1]"},
      {R"({"primitive": "large_shrub/0002", "class": "large_shrubs"})", "edits[1].class"},
      {R"({"primitive": "large_shrub/0002", "class": "ground"})", "edits[1].class"},
      {R"({"primitive": "large_shrub/0002", "class": "low_shrub_patch"})", "edits[1].class"},
      {R"({"primitive": "low_shrub_patch/0001", "class": "low_shrub"})", "edits[1].class"},
      {R"({"primitive": "large_shrub/0002", "name": "two\nlines"})", "edits[1].name"},
      {R"({"primitive": "large_shrub/0002", "title": "b"})", "edits[1]"},
      {R"(7)", "edits[1]"},
  };
  for (const auto& [edit, place] : cases) {
    try {
      merged("library", first + edit);
      ADD_FAILURE() << edit;
    } catch (const FormatError& e) {
      EXPECT_EQ(e.place(), place) << e.what();
    }
  }
  const std::string longest = std::string(kMostNameBytes, 'x');
  EXPECT_NO_THROW(
      merged("library", R"({"primitive": "large_shrub/0002", "name": ")" + longest + "\"}"));
  EXPECT_THROW(
      merged("library", R"({"primitive": "large_shrub/0002", "name": "x)" + longest + "\"}"),
      FormatError);
  EXPECT_THROW(merged("library", first + "{"), FormatError);  // Not JSON.
}

TEST_F(Edits, LeaveOnePrimitiveAtLeast) {
  std::string all;
  const PrimitiveSet set = read("a");
  for (size_t k = 0; k < set.entries.size(); ++k) {
    if (k + 1 == set.entries.size()) {
      EXPECT_EQ(merged("a", all).primitives.size(), 1u);
    }
    all += (k ? ", {\"primitive\": \"" : "{\"primitive\": \"") + set.entries[k].name +
           "\", \"remove\": true}";
  }
  try {
    merged("a", all);
    ADD_FAILURE() << "all primitives were thrown out";
  } catch (const FormatError& e) {
    EXPECT_EQ(e.place(), "edits");
  }
}

TEST_F(Edits, AreOfOneSet) {
  Options o;
  o.edits = "edits.json";
  const fs::path both[] = {folder / "a", folder / "b"};
  EXPECT_THROW(merge_sets(both, o), std::invalid_argument);
  // A list with the hash of a set is for that one alone.
  const std::string list =
      R"({"format": "underbrush-primitive-edits", "version": 1, "edits": [], "set": ")" +
      hash_of_set(read("a")) + "\"}";
  PrimitiveSet a = read("a"), other = read("library");
  EXPECT_NO_THROW(apply_edits(a, list, "edits.json"));
  EXPECT_THROW(apply_edits(other, list, "edits.json"), FormatError);
}

}  // namespace
}  // namespace underbrush::library
