/// \file
/// The option `import --keep`.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/point_scan.hpp"

namespace underbrush::pipeline {

/// The selection of rows by `COLUMN=VALUE`.
class RowFilter {
 public:
  /// If `words` is empty, all rows are selected. Throws `std::invalid_argument` for text of another
  /// form.
  RowFilter(std::string file, const std::string& words);

  bool all() const { return column_.empty(); }
  /// Returns the reason for which a row is left out.
  std::string reason() const;
  /// Returns the selected rows. Throws `FormatError` where there is no such column.
  std::vector<size_t> rows(const std::map<std::string, ExtraColumn>& extra) const;
  /// Removes the other points and counts them in `skipped`.
  void apply(PointScan& scan, std::map<std::string, size_t>& skipped) const;

 private:
  std::string file_, column_;
  double value_ = 0;
};

/// Leaves only these points, which are in ascending order, in a scan.
void keep_rows(const std::vector<size_t>& kept, PointScan& scan);

}  // namespace underbrush::pipeline
