#include "underbrush/movers/scan_image.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::movers {
namespace {

constexpr double kMostGapRad = 2.2 * M_PI / 180;  // between rings that see what lies between them

// Columns without returns take the place of the nearest column before them.
void fill_gaps(const std::vector<uint32_t>& count, std::vector<Vec3>& from) {
  const size_t n = count.size();
  const auto first = size_t(
      std::find_if(count.begin(), count.end(), [](uint32_t c) { return c > 0; }) - count.begin());
  for (size_t k = 1; k < n; ++k) {
    const size_t at = (first + k) % n, before = (first + k - 1) % n;
    if (count[at] == 0) from[at] = from[before];
  }
}

}  // namespace

ScanImage::ScanImage(double time_s, const std::vector<ScanReturn>& returns,
                     const std::vector<Vec3>& from, double cell_rad)
    : time_s_(time_s),
      rows_(int32_t(std::ceil(2 / cell_rad))),
      columns_(int32_t(std::ceil(2 * M_PI / cell_rad))),
      gap_rows_(int32_t(std::ceil(kMostGapRad / cell_rad))),
      from_(size_t(columns_), Vec3::Zero()) {
  require(!returns.empty() && returns.size() == from.size(), "scan image: no returns");
  std::vector<uint32_t> count(from_.size());
  for (size_t i = 0; i < returns.size(); ++i) {
    const auto column = size_t(column_of(returns[i].point - from[i]));
    from_[column] += from[i] - from[0];
    ++count[column];
  }
  for (size_t c = 0; c < from_.size(); ++c) {
    if (count[c] > 0) from_[c] = from[0] + from_[c] / count[c];
  }
  fill_gaps(count, from_);
  int32_t last_row = 0;
  first_row_ = rows_;
  for (const ScanReturn& r : returns) {
    const Place at = place(r.point);
    first_row_ = std::min(first_row_, at.row);
    last_row = std::max(last_row, at.row);
  }
  span_.resize(size_t(last_row - first_row_ + 1) * size_t(columns_));
  for (const ScanReturn& r : returns) {
    const Place at = place(r.point);
    Span& span = span_[index(at.row - first_row_, at.column)];
    if (at.range_m < span.least) span.height_m = float(r.point.z());
    span.least = std::min(span.least, at.range_m);
    span.most = std::max(span.most, at.range_m);
  }
}

int32_t ScanImage::column_of(const Vec3& offset) const {
  const double turn = std::atan2(offset.y(), offset.x()) / (2 * M_PI) + 0.5;
  return std::clamp(int32_t(turn * columns_), 0, columns_ - 1);
}

size_t ScanImage::index(int32_t row, int32_t column) const {
  return size_t(row) * size_t(columns_) + size_t(column);
}

// The place of the sensor depends on the column, and the column on that place.
ScanImage::Place ScanImage::place(const Vec3& point) const {
  const int32_t guess = column_of(point - from_[0]);
  const int32_t better = column_of(point - from_[size_t(guess)]);
  const Vec3 offset = point - from_[size_t(better)];
  const double range = std::max(offset.norm(), 1e-9);
  const double turn = (offset.z() / range + 1) / 2;
  return {std::clamp(int32_t(turn * rows_), 0, rows_ - 1), column_of(offset), float(range)};
}

const ScanImage::Span& ScanImage::span(int32_t row, int32_t column) const {
  static const Span none;
  const size_t at = index(row - first_row_, column);
  return row < first_row_ || at >= span_.size() ? none : span_[at];
}

// The first cell with returns from a row on, or null.
const ScanImage::Span* ScanImage::filled(int32_t row, int32_t column, int32_t direction) const {
  for (int32_t k = 0; k <= gap_rows_; ++k, row += direction) {
    if (row < 0 || row >= rows_) return nullptr;
    const Span& s = span(row, column);
    if (!s.is_empty()) return &s;
  }
  return nullptr;
}

PlaceState ScanImage::state_of(const Vec3& point, double same_m, double behind_m) const {
  const Place at = place(point);
  const double range = double(at.range_m);
  const auto is_matter = [&](const Span& s) {
    return double(s.least) <= range + same_m && double(s.most) >= range - same_m;
  };
  for (int32_t row = std::max(0, at.row - 1); row <= std::min(rows_ - 1, at.row + 1); ++row) {
    for (int32_t step = -1; step <= 1; ++step) {
      if (is_matter(span(row, (at.column + step + columns_) % columns_))) {
        return PlaceState::kMatter;
      }
    }
  }
  // Rows without returns lie between the rings of a sensor of few channels.
  const Span& own = span(at.row, at.column);
  const Span* below = filled(at.row - 1, at.column, -1);
  const Span* above = filled(at.row + 1, at.column, 1);
  if (!below) return PlaceState::kUnknown;
  const auto is_behind = [&](const Span& s) { return double(s.least) > range + behind_m; };
  if (is_behind(*below)) {
    const bool is_seen = own.is_empty() ? above && is_behind(*above) : is_behind(own);
    return is_seen ? PlaceState::kEmpty : PlaceState::kUnknown;
  }
  // A beam below ended before the point and one above behind it: on ground that goes on between
  // them, all are of one height.
  const Span& beyond = own.is_empty() && above ? *above : own;
  const auto is_level = [&](const Span& s) {
    return !s.is_empty() && std::abs(double(s.height_m) - point.z()) <= same_m;
  };
  return is_level(*below) && is_level(beyond) ? PlaceState::kMatter : PlaceState::kUnknown;
}

double ScanImage::solid_share(const Place& at, double same_m) const {
  int solid = 0, filled = 0;
  for (int32_t row = std::max(0, at.row - 1); row <= std::min(rows_ - 1, at.row + 1); ++row) {
    for (int32_t step = -1; step <= 1; ++step) {
      const Span& s = span(row, (at.column + step + columns_) % columns_);
      if (s.is_empty()) continue;
      ++filled;
      solid += double(s.least) >= double(at.range_m) - same_m &&
               double(s.most) <= double(at.range_m) + same_m;
    }
  }
  return filled == 0 ? 0 : double(solid) / filled;
}

}  // namespace underbrush::movers
