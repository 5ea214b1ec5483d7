#include "underbrush/primitives/given_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::primitives {
namespace fs = std::filesystem;
namespace {

/// The content of the file, with one entry for each row.
struct Rows {
  std::vector<uint32_t> label, instance;
  std::vector<Vec3> point;  // Empty for .label files.
  size_t not_numbers = 0;
  size_t size() const { return std::max(label.size(), instance.size()); }
};

/// The log's hits, and the beams that they belong to.
struct Hits {
  std::vector<Vec3> point;
  std::vector<uint64_t> beam;
  size_t beams = 0;
};

Hits hits_of(BeamSource& log) {
  Hits hits;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i, ++hits.beams) {
      if (!chunk.is_hit(i)) continue;
      hits.point.push_back(chunk.end_point(i));
      hits.beam.push_back(hits.beams);
    }
  }
  return hits;
}

std::vector<uint32_t> whole_numbers(const fs::path& file, const ExtraColumn& column,
                                    size_t& not_numbers) {
  std::vector<uint32_t> out;
  for (const double v : io::doubles_of(column)) {
    if (std::isnan(v)) {
      ++not_numbers;
      out.push_back(0);
      continue;
    }
    if (!(v >= 0 && v <= UINT32_MAX && v == std::floor(v))) {
      throw FormatError(file.string(), "row " + std::to_string(out.size() + 1),
                        "a label must be a whole number from 0 on, not " + std::to_string(v));
    }
    out.push_back(uint32_t(v));
  }
  return out;
}

Rows read_label_file(const fs::path& file) {
  const std::string bytes = read_file(file);
  if (bytes.size() % 4 != 0) throw FormatError(file.string(), "", "ends inside a label: truncated");
  Rows rows;
  for (size_t at = 0; at < bytes.size(); at += 4) {
    uint32_t word;
    std::memcpy(&word, bytes.data() + at, 4);
    rows.label.push_back(word & 0xffff);
    rows.instance.push_back(word >> 16);
  }
  return rows;
}

Rows read_point_file(const fs::path& file) {
  const io::Table table = io::read_table(file);
  Rows rows;
  const ExtraColumn* label = table.find({"class", "classification", "label"});
  const ExtraColumn* instance = table.find({"instance"});
  if (!label && !instance) {
    throw FormatError(file.string(), "header", "no column 'class' or 'instance'");
  }
  if (label) rows.label = whole_numbers(file, *label, rows.not_numbers);
  if (instance) rows.instance = whole_numbers(file, *instance, rows.not_numbers);
  std::array<std::vector<double>, 3> xyz;
  for (size_t d = 0; d < 3; ++d) {
    const std::string name(1, char('x' + d));
    const ExtraColumn* column = table.find({name});
    if (!column) throw FormatError(file.string(), "header", "no column '" + name + "'");
    xyz[d] = io::doubles_of(*column);
  }
  for (size_t i = 0; i < xyz[0].size(); ++i) {
    rows.point.emplace_back(xyz[0][i], xyz[1][i], xyz[2][i]);
  }
  return rows;
}

// Returns the row of each hit by order, or nothing where the number of rows or their places
// disagree.
std::optional<std::vector<size_t>> rows_by_order(const Rows& rows, const Hits& hits,
                                                 double tolerance_m) {
  if (rows.size() != hits.beams && rows.size() != hits.point.size()) return std::nullopt;
  std::vector<size_t> row(hits.point.size());
  for (size_t k = 0; k < row.size(); ++k) {
    row[k] = rows.size() == hits.beams ? hits.beam[k] : k;
    if (!rows.point.empty() && !((rows.point[row[k]] - hits.point[k]).norm() <= tolerance_m)) {
      return std::nullopt;
    }
  }
  return row;
}

// Row of each hit by place, SIZE_MAX where none is near.
std::vector<size_t> rows_by_place(const Rows& rows, const Hits& hits, double tolerance_m) {
  std::vector<size_t> row(hits.point.size(), SIZE_MAX);
  if (rows.point.empty()) return row;
  const KdTree tree(
      rows.point.size(), [&](size_t i, size_t axis) { return rows.point[i][Eigen::Index(axis)]; },
      16);
  parallel_for(row.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      uint32_t nearest = 0;
      double distance2 = 0;
      tree.nearest(hits.point[k].data(), 1, &nearest, &distance2);
      if (distance2 <= tolerance_m * tolerance_m) row[k] = nearest;
    }
  });
  return row;
}

// Returns the label set that a log of ours names for its column `class`; empty for any other file.
std::string set_of_log(const fs::path& file) {
  if (!io::is_log_name(file)) return {};
  try {
    return io::LogReader(file).info().classes;
  } catch (const FormatError&) {
    return {};
  }
}

void check_set(const fs::path& file, const GivenLabels& given) {
  const auto known = elements::labels_of(given.set);
  if (known.empty()) {
    throw FormatError(file.string(), "",
                      "the label set " + in_quotes(given.set) +
                          ", which it or the log names, is not known (see --label-set)");
  }
  std::vector<uint32_t> numbers;
  for (const auto& l : known) numbers.push_back(l.number);
  std::sort(numbers.begin(), numbers.end());
  for (const uint32_t label : given.label) {
    if (!std::binary_search(numbers.begin(), numbers.end(), label)) {
      throw FormatError(file.string(), "",
                        "class " + std::to_string(label) + " is not in the label set '" +
                            given.set + "' (see --label-set)");
    }
  }
}

}  // namespace

GivenLabels read_given_labels(const fs::path& file, BeamSource& log, const GivenLabelOptions& o) {
  require(o.set.empty() || !elements::labels_of(o.set).empty(), "labels: unknown label set");
  const bool words = file.extension() == ".label";
  Rows rows = words ? read_label_file(file) : read_point_file(file);
  const Hits hits = hits_of(log);
  GivenLabels given;
  given.set = o.set;
  if (given.set.empty()) given.set = words ? "semantickitti" : set_of_log(file);
  if (given.set.empty()) given.set = log.info().classes;
  if (given.set.empty()) given.set = "underbrush";
  given.not_numbers = rows.not_numbers;
  std::vector<size_t> row;
  if (auto ordered = rows_by_order(rows, hits, o.tolerance_m)) {
    row = std::move(*ordered);
  } else if (words) {
    throw FormatError(file.string(), "",
                      std::to_string(rows.size()) + " labels for " + std::to_string(hits.beams) +
                          " beams with " + std::to_string(hits.point.size()) + " hits");
  } else {
    row = rows_by_place(rows, hits, o.tolerance_m);
    given.by_place = true;
    given.unmatched = size_t(std::count(row.begin(), row.end(), SIZE_MAX));
    if (given.unmatched == row.size()) {
      throw FormatError(file.string(), "", "none of its points lies at a hit of the log");
    }
  }
  const auto pick = [&](const std::vector<uint32_t>& from) {
    std::vector<uint32_t> out(from.empty() ? 0 : row.size(), 0);
    for (size_t k = 0; k < out.size(); ++k) {
      if (row[k] != SIZE_MAX) out[k] = from[row[k]];
    }
    return out;
  };
  given.label = pick(rows.label);
  given.instance = pick(rows.instance);
  check_set(file, given);
  return given;
}

}  // namespace underbrush::primitives
