#include "underbrush/primitives/given_labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <numeric>

#include "io/temporary.hpp"
#include "primitives/sites.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/ply.hpp"

namespace underbrush::primitives {
namespace {

using Folder = io::TemporaryFolder;

// Scattered returns, with a miss after every third of them.
struct LabelledSite {
  std::vector<Vec3> points;
  std::vector<uint32_t> label, instance;
  BeamLog log;
};

LabelledSite site(uint64_t seed) {
  Stream random(seed);
  LabelledSite s;
  for (int k = 0; k < 3000; ++k) {
    const double x = random.uniform(-40, 40), y = random.uniform(-40, 40), z = random.uniform(0, 9);
    s.points.emplace_back(x, y, z);
    s.label.push_back(uint32_t(random.below(14)));
    s.instance.push_back(uint32_t(random.below(16'000'000)));
  }
  BeamLog hits = test::labelled_log(s.points, {}, {});
  hits.extra.clear();
  s.log = hits.like();
  for (size_t i = 0; i < hits.size(); ++i) {
    s.log.append(hits, i);
    if (i % 3 == 0) s.log.resize(s.log.size() + 1);
  }
  return s;
}

/// Writes the file as CloudCompare does, with float coordinates and float scalar fields.
void write_like_cloud_compare(const std::filesystem::path& path, const LabelledSite& s,
                              const std::vector<size_t>& order) {
  io::PlyElement e;
  e.name = "vertex";
  e.count = order.size();
  std::vector<float> columns[5];
  for (const size_t i : order) {
    for (int d = 0; d < 3; ++d) columns[d].push_back(float(s.points[i][d]));
    columns[3].push_back(float(s.label[i]));
    columns[4].push_back(float(s.instance[i]));
  }
  const char* names[] = {"x", "y", "z", "scalar_Class", "scalar_instance"};
  for (int c = 0; c < 5; ++c) e.columns.emplace_back(names[c], std::move(columns[c]));
  io::PlyData data;
  data.elements = {e};
  io::write_ply(path, data);
}

TEST(GivenLabels, ComeBackWithoutLossHoweverTheyWereShuffled) {
  const Folder folder;
  LabelledSite s = site(1);
  std::vector<size_t> order(s.points.size());
  std::iota(order.begin(), order.end(), size_t(0));
  MemorySource source(s.log, 700);
  for (const bool shuffled : {false, true}) {
    if (shuffled) {
      Stream random(2);
      for (size_t k = order.size() - 1; k > 0; --k) std::swap(order[k], order[random.below(k + 1)]);
    }
    write_like_cloud_compare(folder / "edited.ply", s, order);
    const GivenLabels given = read_given_labels(folder / "edited.ply", source);
    EXPECT_EQ(given.by_place, shuffled);
    EXPECT_EQ(given.unmatched, 0u);
    EXPECT_EQ(given.label, s.label);
    EXPECT_EQ(given.instance, s.instance);
    EXPECT_EQ(given.set, "underbrush");
  }
  order.resize(order.size() / 2);  // half of the points are cut away
  write_like_cloud_compare(folder / "half.ply", s, order);
  const GivenLabels half = read_given_labels(folder / "half.ply", source);
  EXPECT_EQ(half.unmatched, s.points.size() - order.size());
  for (const size_t i : order) EXPECT_EQ(half.label[i], s.label[i]);
}

TEST(GivenLabels, OfSemanticKittiAreWordsInOrder) {
  const Folder folder;
  LabelledSite s = site(3);
  for (uint32_t& l : s.label) l = l % 2 ? 70 : 40;
  for (uint32_t& i : s.instance) i &= 0xffff;
  std::ofstream out(folder / "a.label", std::ios::binary);
  for (size_t i = 0; i < s.label.size(); ++i) {
    const uint32_t word = s.instance[i] << 16 | s.label[i];
    out.write(reinterpret_cast<const char*>(&word), 4);
  }
  out.close();
  MemorySource source(s.log);
  const GivenLabels given = read_given_labels(folder / "a.label", source);
  EXPECT_EQ(given.label, s.label);
  EXPECT_EQ(given.instance, s.instance);
  EXPECT_EQ(given.set, "semantickitti");
  std::filesystem::resize_file(folder / "a.label", 400);
  EXPECT_THROW(read_given_labels(folder / "a.label", source), FormatError);
}

TEST(GivenLabels, ThatAreWrongAreRefused) {
  const Folder folder;
  LabelledSite s = site(4);
  MemorySource source(s.log);
  const auto refused = [&](const std::string& csv, const std::string& why) {
    std::ofstream(folder / "a.csv") << csv;
    try {
      read_given_labels(folder / "a.csv", source);
      ADD_FAILURE() << csv;
    } catch (const FormatError& e) {
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  refused("x,y,z,colour\n1,2,3,4\n", "no column 'class'");
  refused("class\n4\n", "no column 'x'");
  refused("x,y,z,class\n1,2,3,4.5\n", "whole number");
  refused("x,y,z,class\n1,2,3,-1\n", "whole number");
  refused("x,y,z,class\n1e5,2,3,4\n", "none of its points");
  const Vec3 p = s.points[0];
  const std::string at =
      std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z());
  refused("x,y,z,class\n" + at + ",99\n", "label set");
  std::ofstream(folder / "b.csv") << "x,y,z,class\n" + at + ",nan\n";
  const GivenLabels given = read_given_labels(folder / "b.csv", source);
  EXPECT_EQ(given.not_numbers, 1u);
  EXPECT_EQ(given.label[0], 0u);
  s.log.info.classes = "own";
  MemorySource of_own_set(s.log);
  EXPECT_THROW(read_given_labels(folder / "b.csv", of_own_set), FormatError);
  GivenLabelOptions wrong;
  wrong.set = "own";
  EXPECT_THROW(read_given_labels(folder / "b.csv", source, wrong), std::invalid_argument);
}

}  // namespace
}  // namespace underbrush::primitives
