/// \file
/// This file maps the free space around a vehicle on a grid, and distinguishes solid obstacles from
/// permeable matter ([rosenberger20] §5).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "underbrush/perception/cloud.hpp"

namespace underbrush::perception {

/// The content of a cell.
enum class CellState : uint8_t {
  kFree,
  kPermeable,  ///< Vegetation: some beams end in it, and others pass through it.
  kSolid
};

/// The options of `OccupancyGrid`.
struct GridOptions {
  double cell_m = 0.2;
  double half_side_m = 40;  ///< m; the grid reaches so far from the vehicle, along x and y.
  /// Probability that a beam which enters a cell of each state in the band of heights ends in it.
  std::array<double, 3> hit{0.02, 0.35, 0.95};
  /// Probabilities before anything was measured. With 0 for permeable matter the grid is the usual
  /// one of two states.
  std::array<double, 3> prior{0.5, 0.25, 0.25};
  double low_m = 0.2, high_m = 2;  ///< Heights above the vehicle's z = 0 at which matter counts.
  double memory = 0.9;             ///< Share of the evidence that stays from cycle to cycle.
  double most_evidence = 20;       ///< Limit of the log-odds between two states.

  /// Throws `std::invalid_argument` where a value is out of range.
  void check() const;
};

/// A grid of log-odds ([moravec85]) with three states instead of two.
///
/// A beam that ends in a cell, at a height in the band, counts as a hit, and one that crosses a
/// cell in the band as a pass. A cell of state s is hit with the probability `hit[s]`, so h hits
/// and n passes of a cycle add h ln hit[s] + n ln (1 − hit[s]) to the logarithm of its likelihood.
/// A beam that passes through grass thus lowers the odds of an obstacle there, and hits among
/// passes raise those of vegetation. The order of the beams has no effect.
///
/// A beam that ends below the band counts as a pass of the cells that it crossed in the band. The
/// cells are those of the world's axes, and the grid moves with the vehicle by whole cells. After
/// the first cycle it allocates no memory.
class OccupancyGrid {
 public:
  /// Throws `std::invalid_argument` for options out of range.
  explicit OccupancyGrid(const GridOptions& options = {});
  /// Enters the beams of a cycle.
  void step(const MergedCloud& cloud);
  /// Forgets all cells.
  void reset();

  /// The number of cells along each side.
  size_t columns() const { return columns_; }
  double cell_m() const { return options_.cell_m; }
  /// The corner of the grid with the least x and y, world frame, m.
  std::array<double, 2> corner_m() const;
  /// The probabilities of the three states of a cell, by its column (x) and row (y).
  std::array<double, 3> probability(size_t x, size_t y) const;
  /// The index of the cell that holds a point of the world, or nothing.
  std::optional<size_t> cell_at(double x_m, double y_m) const;
  std::array<double, 3> probability(size_t cell) const;

 private:
  /// Logarithms of the likelihoods of the states, of which the largest is 0.
  using Evidence = std::array<float, 3>;
  /// The beams of a cycle that a cell has met.
  struct Count {
    uint32_t passes = 0, hits = 0;
  };
  void move_to(const Vec3& vehicle);
  void count(const Vec3& from, const Vec3& to, bool is_hit);
  void count_cells(const Vec3& from, const Vec3& step, double begin, double end, bool is_hit);
  void add_counts();

  GridOptions options_;
  size_t columns_;
  int64_t first_x_ = 0, first_y_ = 0;  ///< Cell of the world of column and row 0.
  bool is_placed_ = false;
  Evidence on_hit_{}, on_pass_{};
  std::vector<Evidence> cells_, moved_;
  std::vector<Count> counts_;  ///< One for each cell and for a border, one cell wide.
  std::vector<Vec3> sensors_;  ///< Places of the sensors, in cells from the corner of the border.
};

}  // namespace underbrush::perception
