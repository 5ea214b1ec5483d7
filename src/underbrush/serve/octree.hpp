/// \file
/// An octree of a log's points on disk, of which a viewer reads the parts that it shows. Layout:
/// docs/reference/octree.md.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush {
/// The server behind `underbrush serve`: octrees of points, the HTTP server and its answers.
namespace serve {

/// Version of the layout that is written. Files of other versions are made anew.
inline constexpr uint32_t kOctreeVersion = 1;
/// Cells along each side of a node. A node that has children holds at most one point per cell.
inline constexpr uint32_t kNodeCells = 64;
/// A node with at most so many points left has no children.
inline constexpr size_t kLeafPoints = 8192;
/// Bytes of a point in a node.
inline constexpr size_t kPointBytes = 29;

/// The start of the file, little-endian.
struct OctreeHeader {
  std::array<char, 8> magic{'U', 'B', 'O', 'C', 'T', 'R', 'E', 'E'};
  uint32_t version = kOctreeVersion;
  uint32_t nodes = 0;       ///< Number of nodes.
  uint64_t points = 0;      ///< Number of points of all nodes.
  uint64_t nodes_at = 0;    ///< Byte at which the table of nodes begins.
  uint64_t runs_at = 0;     ///< Byte at which the table of runs begins.
  uint64_t runs = 0;        ///< Number of runs.
  uint64_t json_at = 0;     ///< Byte at which the description begins.
  uint64_t json_bytes = 0;  ///< Length of the description.
};
static_assert(sizeof(OctreeHeader) == 64);

/// A row of the table of nodes. The nodes are in order of level, and the children of a node follow
/// each other in order of their octant (bit 0 = upper half in x, bit 1 in y, bit 2 in z).
struct OctreeNode {
  uint64_t at = 0;           ///< Byte at which the node's points begin.
  uint32_t points = 0;       ///< Number of points of the node itself.
  uint32_t first_child = 0;  ///< Row of the first child.
  uint8_t children = 0;      ///< Bit k is set if there is a child in octant k.
  uint8_t level = 0;         ///< 0 for the root.
  std::array<uint8_t, 6> zero{};
};
static_assert(sizeof(OctreeNode) == 24);

/// Rows of the log that follow each other and belong to one scan: a place from which to read the
/// log. A run has 256 rows at least, unless it is the last one.
struct OctreeRun {
  uint64_t first_row = 0, first_beam = 0;
  uint32_t rows = 0, scan = 0;
  double time_s = 0;  ///< Time of the first row.
};
static_assert(sizeof(OctreeRun) == 32);

/// Options of `build_octree`.
struct OctreeOptions {
  /// Points of a part of the tree that is built in memory; at least 65 536. The result does not
  /// depend on it, except for the order in which the nodes lie in the file.
  size_t chunk_points = 2'000'000;
  /// Memory for parts that are built at the same time, bytes; one part is always allowed.
  size_t memory_bytes = size_t(3) << 28;
  /// Text that the description repeats as `source`, by which the cache identifies the log.
  std::string source;
  /// A function that gets the amount done and the total; may be empty. Called from one thread.
  std::function<void(size_t done, size_t total)> progress;
};

/// Writes the octree of all returns of a log to the new file `path`. The log is read twice. Points
/// beyond memory go to a file in the folder of `path`.
///
/// A node takes of its points the one of each cell whose row has the least hash, and hands the
/// others on to its children. The points of a node and of all nodes above it are therefore an even
/// sample without holes, whatever the order of the log. Within a node, points are in the order of
/// that hash, so that the first n of them are a sample too.
///
/// Throws `DataError` where the log is empty, has 2³² rows or more, or has more than `chunk_points`
/// points at one place; `IoError` where the file cannot be written; and what the source throws.
void build_octree(BeamSource& log, const std::filesystem::path& path,
                  const OctreeOptions& options = {});

/// An octree file, open for reading from several threads.
class OctreeFile {
 public:
  /// Throws `FormatError` where the file is not a whole octree of this version.
  explicit OctreeFile(const std::filesystem::path& path);

  const OctreeHeader& header() const { return header_; }
  /// The description, a JSON object.
  const std::string& json() const { return json_; }
  const std::vector<OctreeNode>& nodes() const { return nodes_; }
  const std::vector<OctreeRun>& runs() const { return runs_; }
  uint64_t bytes() const { return file_.size(); }
  /// Reads bytes of the file. Throws `FormatError` where it ends before.
  void read(uint64_t at, void* to, size_t n) const { file_.read(at, to, n); }

 private:
  InputFile file_;
  OctreeHeader header_;
  std::string json_;
  std::vector<OctreeNode> nodes_;
  std::vector<OctreeRun> runs_;
};

/// The points of a node in columns, as the file has them.
struct OctreePoints {
  std::vector<Vec3f> position;  ///< m, from the corner of the node with the least coordinates.
  std::vector<float> intensity, time_s;  ///< Time since the first row of the log.
  std::vector<uint32_t> row;
  std::vector<uint16_t> ring, label;
  std::vector<uint8_t> echo;
};
/// Reads a node's points.
OctreePoints read_points(const OctreeFile& file, const OctreeNode& node);

}  // namespace serve
}  // namespace underbrush
