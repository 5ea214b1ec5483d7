#include <cstring>

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
  if (nodes_.empty()) fail("nodes", "no root");
  uint64_t points = 0;
  for (const OctreeNode& n : nodes_) {
    const size_t children = size_t(__builtin_popcount(n.children));
    if (n.at > header_.nodes_at || n.points * kPointBytes > header_.nodes_at - n.at ||
        (children > 0 && n.first_child + children > nodes_.size())) {
      fail("nodes", "a node beyond the end of the file");
    }
    points += n.points;
  }
  if (points != header_.points) fail("nodes", "another number of points than the header says");
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
