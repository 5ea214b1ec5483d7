/// \file
/// Changes of the labels of a log's rows, in a form that can be stored, applied and taken back.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace underbrush::serve {

/// Classes that a document can have; the class of a row is an index into the document's list.
inline constexpr uint32_t kMostClasses = 128;
/// The greatest number of an instance.
inline constexpr uint32_t kMostInstance = (1u << 24) - 1;

/// The label of a row in 32 bits: bits 0–6 are the class, bit 7 is set if the row is selected, and
/// bits 8–31 are the instance, 0 for none. A row without a return has 0.
struct LabelValue {
  uint32_t label = 0, instance = 0;
  bool selected = false;

  static LabelValue of(uint32_t bits) { return {bits & 127u, bits >> 8, (bits & 128u) != 0}; }
  uint32_t bits() const { return label | (selected ? 128u : 0u) | instance << 8; }
};

/// Rows in ascending order, as pairs of numbers of variable length: the number of rows that are
/// left out, and of those that follow.
class RowRuns {
 public:
  /// Adds a row, which is greater than all before.
  void add(uint32_t row);
  uint64_t rows() const { return rows_; }
  /// The runs as bytes.
  std::string bytes() const;
  /// Calls `visit(begin, end)` for each run. Throws `std::invalid_argument` where the bytes are no
  /// runs of rows below `limit`.
  static void read(std::string_view bytes, uint64_t limit,
                   const std::function<void(uint64_t, uint64_t)>& visit);

 private:
  void close();
  std::string bytes_;
  uint64_t rows_ = 0, end_ = 0;      ///< End of the last run that is in `bytes_`.
  uint64_t begin_ = 0, length_ = 0;  ///< The run that is still open.
};

/// A change of labels: for each pair of an old and a new value the rows that it concerns.
struct LabelChange {
  std::map<std::pair<uint32_t, uint32_t>, RowRuns> rows;
  /// Nodes of the octree that hold the rows; `everywhere` if that is not known.
  std::vector<uint32_t> nodes;
  bool everywhere = false;
  /// Changes of the same stroke that follow each other are undone together; 0 = alone.
  uint32_t stroke = 0;
  /// The action of the person, such as "lasso: grass".
  std::string name;

  void add(uint32_t row, uint32_t from, uint32_t to) {
    if (from != to) rows[{from, to}].add(row);
  }
  uint64_t size() const;
  /// The change as bytes, which `StoredChange` reads.
  std::string bytes() const;
};

/// A change as it is stored.
struct StoredChange {
  struct Group {
    uint32_t from = 0, to = 0;
    std::string_view runs;
  };
  uint32_t stroke = 0;
  bool everywhere = false;
  std::string name;
  std::vector<uint32_t> nodes;
  std::vector<Group> groups;  ///< Views of the bytes that were read.

  /// Throws `std::invalid_argument` where the bytes are no change.
  static StoredChange read(std::string_view bytes);
  /// Sets the values of all rows from the old to the new, or back. Throws `std::invalid_argument`
  /// and changes nothing where a row is beyond `values` or has another value than expected.
  void apply(std::vector<uint32_t>& values, bool back) const;
};

}  // namespace underbrush::serve
