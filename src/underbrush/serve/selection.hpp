/// \file
/// The selection of points of a log by a person, among all points of the octree and not only among
/// those that are drawn.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/serve/label_change.hpp"
#include "underbrush/serve/octree.hpp"
#include "underbrush/serve/screen_shape.hpp"

namespace underbrush::serve {

/// A box that is turned about the vertical. Coordinates are relative to the octree's origin, m.
struct TurnedBox {
  Vec3 centre = Vec3::Zero(), size = Vec3::Ones();
  double yaw_rad = 0;
};

/// The space between two parallel planes: `from` ≤ normal · point ≤ `to`.
struct Slab {
  Vec3 normal = Vec3::UnitZ();
  double from = 0, to = 0;
};

/// Conditions that all hold for the points of a selection. Without any, these are all points.
struct Selection {
  std::optional<DrawnShape> drawn;
  /// With `drawn`: only points at most this far behind the nearest point of their surroundings on
  /// the picture (squares of `kDepthCellPx`), m; 0 = no limit. Hidden points hide nothing.
  double depth_m = 0;
  std::optional<TurnedBox> box;
  std::optional<Slab> slab;
  /// Times since the first row of the log, s.
  std::optional<std::pair<double, double>> times_s;
  std::optional<uint32_t> scan;
  std::array<bool, kMostClasses> hidden{}, locked{};
  std::optional<uint32_t> label, instance;
  bool selected = false;  ///< Whether only selected rows count.

  /// Whether a row with this label may be changed.
  bool admits(LabelValue value) const;
};

/// Side of the squares in which the nearest point is sought, px.
inline constexpr double kDepthCellPx = 8;

/// A set of rows: one bit for each row of a log.
class RowSet {
 public:
  explicit RowSet(uint64_t rows) : words_((rows + 63) / 64) {}
  /// Adds a row; several threads may add at once.
  void add(uint32_t row);
  bool has(uint32_t row) const { return words_[row / 64] >> (row % 64) & 1; }
  const std::vector<uint64_t>& words() const { return words_; }

 private:
  std::vector<uint64_t> words_;
};

/// The points at which a selection's conditions of place, time and scan hold.
struct FoundRows {
  RowSet rows;
  std::vector<uint32_t> nodes;  ///< Nodes that hold some of them.
};

/// The cubes of an octree's nodes, by row of its table.
struct NodeCubes {
  explicit NodeCubes(const OctreeFile& file);
  Vec3 origin;            ///< World coordinates of the octree's origin, m.
  uint64_t rows = 0;      ///< Rows of the log.
  double side_m = 0;      ///< Side of the root, m.
  std::vector<Vec3> low;  ///< Lowest corner of each node, relative to the origin, m.
};

/// Finds the points at which a selection's conditions of place, time and scan hold; those of labels
/// are left to `admits`, except that hidden points do not hide others. `values` has the labels of
/// all rows.
FoundRows find_rows(const OctreeFile& file, const NodeCubes& cubes, const Selection& selection,
                    const std::vector<uint32_t>& values);

/// A change of the labels of rows.
struct LabelAction {
  std::optional<uint32_t> label, instance;
  std::optional<bool> selected;
  /// Whether all other rows are taken out of the selection.
  bool only = false;
};

/// Returns the change that an action makes of the rows that were found and admitted.
LabelChange change_of(const FoundRows& found, const Selection& selection, const LabelAction& action,
                      const std::vector<uint32_t>& values);

/// Returns histograms of the points that were found and admitted, as JSON: for `height_m` (above
/// the octree's origin) and `intensity` the least and greatest value and the numbers of points in
/// equal steps between them. Empty for no points.
std::string histogram_of(const OctreeFile& file, const NodeCubes& cubes, const FoundRows& found,
                         const Selection& selection, const std::vector<uint32_t>& values);

}  // namespace underbrush::serve
