/// \file
/// This file has an image of the ranges that a scan measured in each direction, with which points
/// of other scans are compared.
#pragma once
#include <cstdint>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush {
/// The search for things that moved while a log was recorded.
namespace movers {

/// The state of a point in space according to one scan.
enum class PlaceState : uint8_t {
  kUnknown,  ///< No beam went there, or something nearer hid it.
  kMatter,   ///< A beam ended there.
  kEmpty     ///< The beams that went there passed it by and ended behind it.
};

/// A return of a scan, as other scans need it for the comparison.
struct ScanReturn {
  uint32_t row = 0;  ///< Row in the log.
  Vec3 point;        ///< World frame, m.
};

/// The least and the largest range of a scan's returns in each cell of bearing and of the sine of
/// elevation, in axes of the world about the place of the sensor at the time of that bearing.
class ScanImage {
 public:
  /// `cell_rad` is the width of a cell. `from` has the place of the sensor for each return.
  ScanImage(double time_s, const std::vector<ScanReturn>& returns, const std::vector<Vec3>& from,
            double cell_rad);

  double time_s() const { return time_s_; }
  /// Returns the state of a point (world, m). The point is matter if a cell around it has a return
  /// whose range differs by no more than `same_m`. Otherwise the point is empty if the beams to its
  /// cell and to the nearest cell below all end more than `behind_m` behind it. If its cell has no
  /// returns, the nearest cells below and above, up to 2.2° away, take its place. A point on ground
  /// that beams graze is matter, too: there some beams end before the point and some behind it, all
  /// at its height.
  PlaceState state_of(const Vec3& point, double same_m, double behind_m) const;

  /// The cell of a point and its range.
  struct Place {
    int32_t row = 0, column = 0;
    float range_m = 0;
  };
  Place place(const Vec3& point) const;
  int32_t rows() const { return rows_; }
  int32_t columns() const { return columns_; }
  /// The greatest distance of two rings, in rows, at which the space between them is visible.
  int32_t gap_rows() const { return gap_rows_; }
  size_t index(int32_t row, int32_t column) const;
  /// Share of the cells with returns, of a cell and the eight around it, whose returns all lie
  /// within `same_m` of this range: 1 within a solid surface, less among leaves.
  double solid_share(const Place& at, double same_m) const;

 private:
  struct Span {
    float least = INFINITY, most = -INFINITY;
    float height_m = 0;  ///< Height of the nearest return in the world.
    bool is_empty() const { return least > most; }
  };
  int32_t column_of(const Vec3& offset) const;
  const Span& span(int32_t row, int32_t column) const;
  const Span* filled(int32_t row, int32_t column, int32_t direction) const;

  double time_s_;
  int32_t rows_, columns_, gap_rows_;
  int32_t first_row_ =
      0;  ///< The first row in `span_`, which ends with the last row that has returns.
  std::vector<Vec3> from_;  ///< Place of the sensor for each column.
  std::vector<Span> span_;
};

}  // namespace movers
}  // namespace underbrush
