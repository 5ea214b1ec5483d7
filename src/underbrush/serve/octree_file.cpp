#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/serve/octree_tree.hpp"

namespace underbrush::serve {
namespace {

template <class T>
std::vector<T> read_table(const InputFile& file, uint64_t at, uint64_t n) {
  if (n > file.size() / sizeof(T) || at > file.size() - n * sizeof(T)) {
    throw FormatError(file.name(), "header", "a table beyond the end of the file");
  }
  std::vector<T> out(n);
  file.read(at, out.data(), n * sizeof(T));
  return out;
}

/// The number of rows in the description, if that has all that its readers take from it.
std::optional<uint64_t> described_rows(const std::string& json) {
  using Corner = std::array<double, 3>;
  try {
    const auto j = nlohmann::json::parse(json);
    j.at("origin_m").get<Corner>();
    j.at("root_low_m").get<Corner>();
    j.at("root_side_m").get<double>();
    j.at("first_time_s").get<double>();
    if (!j.at("rows").is_number_unsigned()) return {};
    return j.at("rows").get<uint64_t>();
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

/// Whether the runs follow each other and are all rows.
bool are_all_rows(const std::vector<OctreeRun>& runs, uint64_t rows) {
  uint64_t next = 0, beam = 0;
  for (const OctreeRun& r : runs) {
    if (r.first_row != next || r.first_beam < beam || r.first_beam > next) return false;
    next += r.rows;
    beam = r.first_beam;
  }
  return next == rows;
}

}  // namespace

OctreeFile::OctreeFile(const std::filesystem::path& path) : file_(path) {
  const auto fail = [&](const char* place, const char* reason) {
    throw FormatError(file_.name(), place, reason);
  };
  file_.read(0, &header_, sizeof(header_));
  if (header_.magic != OctreeHeader().magic) fail("header", "not an octree");
  if (header_.version != kOctreeVersion) fail("header", "an octree of another version");
  nodes_ = read_table<OctreeNode>(file_, header_.nodes_at, header_.nodes);
  runs_ = read_table<OctreeRun>(file_, header_.runs_at, header_.runs);
  const std::vector<char> json = read_table<char>(file_, header_.json_at, header_.json_bytes);
  json_.assign(json.begin(), json.end());
  const std::optional<uint64_t> rows = described_rows(json_);
  if (!rows) fail("description", "damaged");
  if (header_.points > *rows || !are_all_rows(runs_, *rows)) {
    fail("runs", "they are not all rows");
  }
  if (nodes_.empty()) fail("nodes", "no root");
  uint64_t points = 0, next_child = 1;
  for (const OctreeNode& n : nodes_) {
    const size_t children = size_t(__builtin_popcount(n.children));
    if (n.at > header_.nodes_at || n.points * kPointBytes > header_.nodes_at - n.at) {
      fail("nodes", "a node beyond the end of the file");
    }
    if (children > 0 && n.first_child != next_child) fail("nodes", "not a tree");
    next_child += children;
    points += n.points;
  }
  if (next_child != nodes_.size()) fail("nodes", "not a tree");
  if (points != header_.points) fail("nodes", "another number of points than in the header");
}

OctreePoints read_points(const OctreeFile& file, const OctreeNode& node) {
  OctreePoints out;
  uint64_t at = node.at;
  const auto column = [&](auto& to) {
    to.resize(node.points);
    const size_t n = to.size() * sizeof(to[0]);
    file.read(at, static_cast<void*>(to.data()), n);
    at += n;
  };
  column(out.position);
  column(out.intensity);
  column(out.time_s);
  column(out.row);
  column(out.ring);
  column(out.label);
  column(out.echo);
  return out;
}

}  // namespace underbrush::serve
