/// `import --keep`.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/point_scan.hpp"

namespace underbrush::app {

/// `COLUMN=VALUE`: which rows are taken.
class RowFilter {
 public:
  /// `words` may be empty: all. Throws `std::invalid_argument`.
  RowFilter(std::string file, const std::string& words);

  bool all() const { return column_.empty(); }
  /// Why a row is left out.
  std::string reason() const;
  /// Throws `FormatError` where there is no such column.
  std::vector<size_t> rows(const std::map<std::string, ExtraColumn>& extra) const;
  /// Leaves out the other points and counts them.
  void apply(PointScan& scan, std::map<std::string, size_t>& skipped) const;

 private:
  std::string file_, column_;
  double value_ = 0;
};

}  // namespace underbrush::app
