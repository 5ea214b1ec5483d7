// The octree of a log: every point once, samples without holes, and one result for every way of
// building it.
#include "underbrush/serve/octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "io/temporary.hpp"
#include "serve/hills.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/serve/octree_cache.hpp"

namespace underbrush::serve {
namespace {

using io::TemporaryFolder;

/// A node by its level and its corner, with what a reader sees.
struct Seen {
  OctreeNode node;
  std::array<uint32_t, 3> place{};  ///< Place of the node in the grid of its level.
  OctreePoints points;
};

std::vector<Seen> all_nodes(const OctreeFile& file) {
  std::vector<Seen> out{{file.nodes()[0], {}, read_points(file, file.nodes()[0])}};
  for (size_t k = 0; k < out.size(); ++k) {
    uint32_t child = out[k].node.first_child;
    for (uint32_t c = 0; c < 8; ++c) {
      if (!(out[k].node.children >> c & 1)) continue;
      const OctreeNode& n = file.nodes()[child++];
      const auto& at = out[k].place;
      out.push_back({n,
                     {2 * at[0] + (c & 1), 2 * at[1] + (c >> 1 & 1), 2 * at[2] + (c >> 2)},
                     read_points(file, n)});
      EXPECT_EQ(n.level, out[k].node.level + 1);
    }
  }
  EXPECT_EQ(out.size(), file.nodes().size());
  return out;
}

/// The rows of each node, by level and place: what may not depend on how a tree is built.
std::map<std::array<uint32_t, 4>, std::vector<uint32_t>> rows_by_node(const OctreeFile& file) {
  std::map<std::array<uint32_t, 4>, std::vector<uint32_t>> out;
  for (const Seen& s : all_nodes(file)) {
    out[{s.node.level, s.place[0], s.place[1], s.place[2]}] = s.points.row;
  }
  return out;
}

class Octree : public testing::Test {
 protected:
  TemporaryFolder folder_;

  OctreeFile build(const BeamLog& log, const std::string& name = "tree",
                   const OctreeOptions& options = {}) {
    MemorySource source(log, 30000);
    build_octree(source, folder_ / name, options);
    return OctreeFile(folder_ / name);
  }
};

TEST_F(Octree, HoldsEveryReturnOnceWithItsAttributes) {
  const BeamLog log = hills(200000, 80);
  const OctreeFile file = build(log);
  const auto j = nlohmann::json::parse(file.json());
  const Vec3 origin(j["origin_m"][0], j["origin_m"][1], j["origin_m"][2]);
  const Vec3 low(j["root_low_m"][0], j["root_low_m"][1], j["root_low_m"][2]);
  const double side = j["root_side_m"];
  std::vector<uint8_t> seen(log.size());
  for (const Seen& s : all_nodes(file)) {
    const double node_side = side / double(1u << s.node.level);
    for (size_t k = 0; k < s.points.row.size(); ++k) {
      const uint32_t i = s.points.row[k];
      ASSERT_TRUE(log.is_hit(i));
      ASSERT_EQ(seen[i]++, 0);
      Vec3 at = s.points.position[k].cast<double>();
      ASSERT_GE(at.minCoeff(), 0);
      ASSERT_LE(at.maxCoeff(), node_side);
      for (int c = 0; c < 3; ++c) at[c] += node_side * s.place[size_t(c)];
      ASSERT_LT((origin + low + at - log.end_point(i)).norm(), 2e-5);
      ASSERT_EQ(s.points.intensity[k], log.intensity[i]);
      ASSERT_EQ(s.points.time_s[k], float(log.time_s[i] - log.time_s[0]));
      ASSERT_EQ(s.points.ring[k], log.ring[i]);
      ASSERT_EQ(s.points.label[k], std::get<std::vector<uint8_t>>(log.extra.at("class"))[i]);
      ASSERT_EQ(s.points.echo[k], 1);
    }
  }
  size_t returns = 0;
  for (size_t i = 0; i < log.size(); ++i) returns += log.is_hit(i);
  EXPECT_EQ(size_t(std::count(seen.begin(), seen.end(), 1)), returns);
  EXPECT_EQ(j["points"], returns);
  EXPECT_EQ(j["labels"].size(), 2u);
  EXPECT_EQ(j["labels"][1]["name"], "medium_tree");
}

uint32_t cell_of(const Vec3& within, double side) {
  uint32_t cell = 0;
  for (int c = 0; c < 3; ++c) {
    cell = cell * kNodeCells + uint32_t(std::min(63.0, within[c] / side * kNodeCells));
  }
  return cell;
}

// The law of the levels: each cell of a node that holds a point of a node below holds one of the
// node itself, and no cell holds two.
TEST_F(Octree, LevelsHaveNoHoles) {
  const OctreeFile file = build(hills(200000, 80));
  const auto j = nlohmann::json::parse(file.json());
  const double root_side = j["root_side_m"];
  const std::vector<Seen> nodes = all_nodes(file);
  size_t inner = 0;
  for (const Seen& n : nodes) {
    if (n.node.children == 0) continue;
    ++inner;
    const double side = root_side / double(1u << n.node.level);
    std::set<uint32_t> taken;
    size_t on_a_border = 0;
    for (const Vec3f& p : n.points.position) {
      on_a_border += !taken.insert(cell_of(p.cast<double>(), side)).second;
    }
    EXPECT_LE(on_a_border, 2u);  // rounding to float moves few points over a border
    for (const Seen& below : nodes) {
      const uint32_t deeper = uint32_t(below.node.level) - n.node.level;
      if (below.node.level <= n.node.level) continue;
      bool inside = true;
      Vec3 corner;
      for (size_t c = 0; c < 3; ++c) {
        inside = inside && below.place[c] >> deeper == n.place[c];
        corner[Eigen::Index(c)] = double(below.place[c] - (n.place[c] << deeper));
      }
      if (!inside) continue;
      const double child_side = side / double(1u << deeper);
      size_t holes = 0;
      for (const Vec3f& p : below.points.position) {
        holes += !taken.count(cell_of(p.cast<double>() + corner * child_side, side));
      }
      EXPECT_LE(holes, 2u);
    }
  }
  EXPECT_GT(inner, 1u);
}

TEST_F(Octree, APrefixOfANodeIsASample) {
  const OctreeFile file = build(hills(200000, 80));
  const OctreePoints root = read_points(file, file.nodes()[0]);
  std::set<uint32_t> all, half;
  for (size_t k = 0; k < root.row.size(); ++k) {
    const Vec3f& p = root.position[k];
    const uint32_t square = uint32_t(p.x() / 16) * 64 + uint32_t(p.y() / 16);
    all.insert(square);
    if (k < root.row.size() / 2) half.insert(square);
  }
  EXPECT_EQ(all, half);
}

TEST_F(Octree, DoesNotDependOnChunksMemoryThreadsOrOrder) {
  const BeamLog log = hills(400000, 300);
  const auto nodes = rows_by_node(build(log));
  OctreeOptions small;
  small.chunk_points = 65536;
  small.memory_bytes = 1;
  EXPECT_EQ(nodes, rows_by_node(build(log, "chunks", small)));
  const std::string bytes = io::bytes_of(folder_ / "chunks");
  small.memory_bytes = size_t(1) << 30;
  set_threads(1);
  build(log, "one thread", small);
  set_threads(0);
  EXPECT_TRUE(bytes == io::bytes_of(folder_ / "one thread"));
  EXPECT_EQ(folder_.entries(), 3u);  // nothing temporary is left
}

TEST_F(Octree, DividesChunksAgainWhereOneFarPointMakesTheCellsLarge) {
  BeamLog log = hills(300000, 3);
  const OctreeFile near = build(log);
  log.range_m[1] = 4e8f;  // the cells of the first pass become larger than the rest
  OctreeOptions small;
  small.chunk_points = 65536;
  const OctreeFile far = build(log, "far", small);
  EXPECT_EQ(far.header().points, near.header().points);
  std::vector<uint32_t> rows;
  for (const Seen& s : all_nodes(far)) {
    rows.insert(rows.end(), s.points.row.begin(), s.points.row.end());
  }
  std::sort(rows.begin(), rows.end());
  EXPECT_EQ(std::unique(rows.begin(), rows.end()), rows.end());
  EXPECT_EQ(rows.size(), far.header().points);
  // A leaf of a far-reaching tree is as small as one of a near one.
  EXPECT_LE(std::max_element(far.nodes().begin(), far.nodes().end(),
                             [](const auto& a, const auto& b) { return a.points < b.points; })
                ->points,
            size_t(kNodeCells) * kNodeCells * 4);
}

TEST_F(Octree, RunsLeadToEveryRow) {
  const OctreeFile file = build(hills(42345, 50));
  uint64_t row = 0;
  for (const OctreeRun& r : file.runs()) {
    EXPECT_EQ(r.first_row, row);
    EXPECT_EQ(r.first_beam, row);
    EXPECT_EQ(r.scan, row / 5000);
    row += r.rows;
  }
  EXPECT_EQ(row, 42345u);
  EXPECT_EQ(file.runs().size(), 9u);
}

TEST_F(Octree, ALogWithoutReturnsHasAnEmptyRoot) {
  BeamLog log = hills(100, 10);
  std::fill(log.range_m.begin(), log.range_m.end(), kMiss);
  const OctreeFile file = build(log);
  EXPECT_EQ(file.nodes().size(), 1u);
  EXPECT_EQ(file.header().points, 0u);
  EXPECT_THROW(build(log.like(), "empty"), DataError);
}

TEST_F(Octree, PointsAtOnePlaceAreKept) {
  BeamLog log = hills(70000, 10);
  for (size_t i = 0; i < log.size(); ++i) {
    log.origin[i] = Vec3(0, 0, 5);
    log.range_m[i] = 5;
  }
  EXPECT_EQ(build(log).header().points, 70000u);
  OctreeOptions small;
  small.chunk_points = 65536;
  EXPECT_THROW(build(log, "small", small), DataError);
}

TEST_F(Octree, TheCacheIsUsedUntilTheLogChanges) {
  io::write_log(folder_ / "log.ply", hills(20000, 20), "{}");
  const auto cache = folder_ / "cache/underbrush";
  size_t built = 0;
  const auto count = [&](size_t, size_t) { ++built; };
  EXPECT_EQ(kept_octree(folder_ / "log.ply", cache), nullptr);
  EXPECT_EQ(kept_octree(folder_ / "none.ply", cache), nullptr);
  cached_octree(folder_ / "log.ply", cache, count);
  EXPECT_GT(built, 0u);
  EXPECT_EQ(kept_octree(folder_ / "log.ply", cache)->header().points, 18000u);
  built = 0;
  EXPECT_EQ(cached_octree(folder_ / "log.ply", cache, count)->header().points, 18000u);
  EXPECT_EQ(built, 0u);
  io::write_log(folder_ / "log.ply", hills(10000, 20), "{}");
  EXPECT_EQ(kept_octree(folder_ / "log.ply", cache), nullptr);
  EXPECT_EQ(cached_octree(folder_ / "log.ply", cache, count)->header().points, 9000u);
  EXPECT_GT(built, 0u);
  io::put_bytes(octree_place(folder_ / "log.ply", cache), "damaged");
  EXPECT_EQ(cached_octree(folder_ / "log.ply", cache)->header().points, 9000u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(cache), {}), 1);
}

TEST_F(Octree, DamageIsFound) {
  build(hills(20000, 20));
  const std::string whole = io::bytes_of(folder_ / "tree");
  for (const size_t n : {size_t(0), size_t(10), size_t(64), whole.size() / 2, whole.size() - 1}) {
    io::put_bytes(folder_ / "cut", whole.substr(0, n));
    EXPECT_THROW(OctreeFile(folder_ / "cut"), FormatError) << n;
  }
  for (size_t at = 0; at < 64; ++at) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ 0x81);
    io::put_bytes(folder_ / "bad", bytes);
    try {
      const OctreeFile file(folder_ / "bad");
      for (const OctreeNode& n : file.nodes()) read_points(file, n);
    } catch (const FormatError&) {
      continue;
    }
  }
}

// Nodes that lead to each other, and a description without what a selection needs, ended the
// server.
TEST_F(Octree, NodesThatAreNoTreeAndADescriptionWithoutTheRootAreFound) {
  const OctreeFile file = build(hills(200000, 20));
  const std::string whole = io::bytes_of(folder_ / "tree");
  ASSERT_GT(file.nodes().size(), 9u);
  const auto changed = [&](uint64_t at, char by) {
    std::string bytes = whole;
    bytes[at] = by;
    io::put_bytes(folder_ / "bad", bytes);
    return folder_ / "bad";
  };
  const uint64_t child_of_root = file.header().nodes_at + 12, children_of_root = child_of_root + 4;
  EXPECT_THROW(OctreeFile(changed(child_of_root, 0)), FormatError);
  EXPECT_THROW(OctreeFile(changed(child_of_root, 2)), FormatError);
  EXPECT_THROW(OctreeFile(changed(children_of_root, 1)), FormatError);
  for (const char* name : {"origin_m", "root_low_m", "root_side_m", "first_time_s", "rows"}) {
    const size_t at = whole.find(name, file.header().json_at);
    ASSERT_NE(at, std::string::npos) << name;
    EXPECT_THROW(OctreeFile(changed(at, '_')), FormatError) << name;
  }
}

// Labels have four bytes for each row that the description names.
TEST_F(Octree, RunsThatAreNotAllRowsAreFound) {
  const OctreeFile file = build(hills(200000, 20));
  const std::string whole = io::bytes_of(folder_ / "tree");
  const uint64_t last = file.header().runs_at + 32 * (file.header().runs - 1);
  for (const uint64_t at : {last, last + 8, last + 16, file.header().runs_at + 16}) {
    std::string bytes = whole;
    bytes[at + 3] = '\x7f';
    io::put_bytes(folder_ / "bad", bytes);
    EXPECT_THROW(OctreeFile(folder_ / "bad"), FormatError) << at - last;
  }
  std::string bytes = whole;
  const std::string word = "\"rows\":";
  bytes.replace(bytes.find(word, file.header().json_at) + word.size(), 1, "9");
  io::put_bytes(folder_ / "bad", bytes);
  EXPECT_THROW(OctreeFile(folder_ / "bad"), FormatError);
}

}  // namespace
}  // namespace underbrush::serve
