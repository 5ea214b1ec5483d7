#include "underbrush/pipeline/row_filter.hpp"

#include <cstdio>
#include <cstdlib>

#include "underbrush/core/check.hpp"

namespace underbrush::pipeline {

RowFilter::RowFilter(std::string file, const std::string& words) : file_(std::move(file)) {
  if (words.empty()) return;
  const size_t equals = words.find('=');
  char* end = nullptr;
  if (equals != std::string::npos) value_ = std::strtod(words.c_str() + equals + 1, &end);
  require(end && *end == 0 && equals > 0 && equals + 1 < words.size(),
          "import: --keep: expected COLUMN=NUMBER");
  column_ = words.substr(0, equals);
}

std::string RowFilter::reason() const {
  char text[64];
  std::snprintf(text, sizeof text, " is not %g (--keep)", value_);
  return column_ + text;
}

std::vector<size_t> RowFilter::rows(const std::map<std::string, ExtraColumn>& extra) const {
  const auto column = extra.find(column_);
  if (column == extra.end()) throw FormatError(file_, "header", "no column " + column_);
  std::vector<size_t> out;
  std::visit(
      [&](const auto& values) {
        for (size_t i = 0; i < values.size(); ++i) {
          if (double(values[i]) == value_) out.push_back(i);
        }
      },
      column->second);
  return out;
}

void RowFilter::apply(PointScan& scan, std::map<std::string, size_t>& skipped) const {
  if (all()) return;
  const std::vector<size_t> kept = rows(scan.extra);
  if (const size_t left_out = scan.size() - kept.size()) skipped[reason()] += left_out;
  keep_rows(kept, scan);
}

void keep_rows(const std::vector<size_t>& kept, PointScan& scan) {
  const auto take = [&](auto& column) {
    if (column.empty()) return;
    for (size_t k = 0; k < kept.size(); ++k) column[k] = column[kept[k]];
    column.resize(kept.size());
  };
  take(scan.point);
  take(scan.intensity);
  take(scan.time_s);
  take(scan.ring);
  for (auto& [name, column] : scan.extra) std::visit(take, column);
}

}  // namespace underbrush::pipeline
