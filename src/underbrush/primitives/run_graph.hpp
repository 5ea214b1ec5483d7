/// \file
/// Points sorted into columns, and in each column into runs without an empty gap. The search for
/// objects works on these runs.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/core/pose.hpp"

namespace underbrush::primitives {

/// Height (m) of a bin.
inline constexpr double kLayerM = 0.2;

/// The points of a column between two empty gaps.
struct Run {
  int32_t y, x, low, high;  ///< Column; lowest and highest bin, both included.
  uint32_t points;
  float top_m;  ///< m above the ground.
};

/// Collects points, then sorts them into runs. Memory grows with the number of columns that hold
/// points.
class RunGraph {
 public:
  /// Index that stands for no run.
  static constexpr uint32_t kNone = UINT32_MAX;

  /// Sets the side (m) of the columns and the empty height (m) between runs; 0 has the meaning that
  /// it has in `ObjectOptions`.
  RunGraph(double cell_m, double gap_m);

  /// Adds points: x and y (m) in any frame, z (m) above the ground. Points that are not finite or
  /// lie beyond 1000 km are ignored.
  void add(std::span<const Vec3f> points);
  /// Sorts all points added into runs, by row (y), column (x) and height.
  void build();

  const std::vector<Run>& runs() const { return runs_; }
  /// Returns the side of the columns (m).
  double cell_m() const { return cell_m_; }
  /// Whether columns are wide, which means that the scan is from far above.
  bool is_sparse() const { return cell_m_ >= 0.5; }
  /// Returns the horizontal distance (m) of two runs' columns.
  double distance_m(const Run& a, const Run& b) const {
    return cell_m_ * std::hypot(double(a.x) - b.x, double(a.y) - b.y);
  }
  /// Returns the runs of a column, from the ground up.
  std::span<const Run> column(int32_t x, int32_t y) const;
  uint32_t index_of(const Run& run) const { return uint32_t(&run - runs_.data()); }
  /// Returns the run that holds the point, or `kNone`. Call `build()` first.
  uint32_t run_at(const Vec3f& point) const;

  /// Calls f(j) for each run j in the eight columns around run i that is within the gap in height.
  template <class F>
  void for_each_neighbour(uint32_t i, const F& f) const {
    const Run& r = runs_[i];
    const auto gap = int32_t(std::lround(gap_m_ / kLayerM));
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0) continue;
        for (const Run& other : column(r.x + dx, r.y + dy)) {
          if (other.low - r.high <= gap && r.low - other.high <= gap) f(index_of(other));
        }
      }
    }
  }

 private:
  struct Bin {
    int32_t y, x, z;
    uint32_t points;
    float top_m;
  };
  static bool before(const Bin& a, const Bin& b);
  static void merge(std::vector<Bin>& bins);
  void choose_cell();
  void make_runs();

  double base_m_, cell_m_, gap_m_;
  bool is_cell_given_;
  int32_t cells_ = 1;  // Number of base columns along a side of a column.
  std::vector<Bin> bins_;
  size_t merged_ = 0;
  std::vector<Run> runs_;
  int32_t first_row_ = 0;
  std::vector<uint32_t> row_begin_;
};

}  // namespace underbrush::primitives
