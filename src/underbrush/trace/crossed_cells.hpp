/// \file
/// The cells of a map that beams crossed, for look-ups along rays.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/elements/observed_space.hpp"

namespace underbrush::trace {

/// The cells of the middles of steps in a row.
struct StepCells {
  static constexpr int kSteps = 8;
  std::array<int32_t, kSteps> x, y, z;

  Cell3 of(int step) const { return {x[size_t(step)], y[size_t(step)], z[size_t(step)]}; }
  void set(int step, const Cell3& to) {
    x[size_t(step)] = to.x;
    y[size_t(step)] = to.y;
    z[size_t(step)] = to.z;
  }
};
/// Finds the cells (side `cell_m`) of the middles of the steps of length `step_m` that begin at the
/// range `from_m`.
void cells_of_steps(const Vec3& start, const Vec3& direction, double from_m, double step_m,
                    double cell_m, StepCells& cells);

/// The steps, as bits, whose cell is not that of the step before; `last` is the cell before the
/// first step.
uint32_t entered_cells(const StepCells& cells, const Cell3& last);

/// The steps, as bits, that have a draw of at most `most` in their cells. The draw of a cell is
/// uniform, of the cell's hash and `key`.
uint32_t drawn_at_most(double most, uint64_t key, const StepCells& cells);
/// The uniform draw of a cell's hash for `key`. Different numbers `what` give different draws.
inline double drawn_in_cell(uint64_t key, uint64_t cell, uint32_t what) {
  return uniform_from_bits(random_bits(mix64(key ^ cell), what, Purpose::kUnknown));
}

/// The cells of a map of observed space that a beam crossed: a bit for each cell. The bits of a
/// block are found by tables: of squares in the plane, and of the blocks above a square.
class CrossedCells {
 public:
  /// Layers of cells, by their z; none where `last` is smaller.
  struct Layers {
    int32_t first = 0, last = -1;
  };
  /// Layers above each cell of a column of blocks; x fastest.
  using ColumnLayers =
      std::array<Layers, size_t(elements::ObservedBlock::kSide) * elements::ObservedBlock::kSide>;
  /// The layers in which there may be matter, for the column of blocks that begins with the cell
  /// (x, y).
  using MatterAbove = std::function<ColumnLayers(int32_t, int32_t)>;

  /// Cells of the map's columns of blocks in which there is no matter count as crossed.
  explicit CrossedCells(const elements::ObservedSpace& space, const MatterAbove& matter = {});

  /// Whether a beam crossed a cell.
  bool holds(const Cell3& c) const { return word(c.x, c.y, c.z) >> bit(c.x, c.y) & 1; }
  /// The steps, as bits, whose cells a beam crossed.
  uint32_t among(const StepCells& cells) const;
  class Way;
  /// The steps among the bits `of` whose cells no beam crossed.
  uint32_t without(uint32_t of, const StepCells& cells) const {
    for (uint32_t left = of; left != 0; left &= left - 1) {
      const int step = std::countr_zero(left);
      of &= ~(uint32_t(holds(cells.of(step))) << step);
    }
    return of;
  }

 private:
  static constexpr int kSide = elements::ObservedBlock::kSide;
  static constexpr uint32_t kWords = elements::ObservedBlock::kCells / 32;
  /// What is known of a column of blocks.
  struct Column {
    int32_t top = INT32_MAX;  ///< The highest layer with matter.
    /// For the columns that a line of a block's length may come into, by `falls`: layers whose
    /// cells are all crossed, and the highest other layer.
    std::array<Layers, 4> crossed;
    std::array<int32_t, 4> above{INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
  };

  /// Counts the cells without matter as crossed.
  void leave_out(const elements::ObservedSpace& space, const MatterAbove& matter);
  /// The layers of each column of blocks whose cells are all crossed, as bits: a byte for each
  /// block of height, and one for those above the map.
  std::vector<uint8_t> crossed_layers(const elements::ObservedSpace& space) const;
  void find_layers(const elements::ObservedSpace& space);
  /// The place of a cell's bit in its word: by y and x.
  static uint32_t bit(int32_t x, int32_t y) { return uint32_t(8 * (y & 3) + (x & 7)); }
  /// The number of the square of a cell; 0 where the map has none.
  uint32_t square(int32_t x, int32_t y) const {
    const int32_t i = std::clamp((x >> (3 + log_side_)) - low_.x, -1, size_.x) + 1,
                  j = std::clamp((y >> (3 + log_side_)) - low_.y, -1, size_.y) + 1;
    return squares_[uint32_t(j * (size_.x + 2) + i)];
  }
  /// The place of a cell's column of blocks in its square.
  uint32_t in_square(int32_t x, int32_t y) const {
    const int32_t mask = (1 << log_side_) - 1;
    return uint32_t((y >> 3 & mask) << log_side_ | (x >> 3 & mask));
  }
  /// The place of a cell's column of blocks among `columns_`.
  uint32_t column_of(int32_t x, int32_t y) const {
    return square(x, y) << 2 * log_side_ | in_square(x, y);
  }
  /// The place of a cell's block among `blocks_`.
  uint32_t place(int32_t x, int32_t y, int32_t z) const {
    const int32_t k = std::clamp((z >> 3) - low_.z, -1, size_.z) + 1;
    return (square(x, y) * uint32_t(size_.z + 2) + uint32_t(k)) << 2 * log_side_ | in_square(x, y);
  }
  /// The word that holds the bit of a cell.
  uint32_t word(int32_t x, int32_t y, int32_t z) const {
    return words_[blocks_[place(x, y, z)] * kWords + uint32_t((z & 7) << 1 | (y >> 2 & 1))];
  }

  // The first part or the border of each table is empty, for what the map does not hold.
  int log_side_ = 4;               // squares have 2^log_side_ blocks a side
  Cell3 low_{}, size_{};           // the first square and block of height, and their numbers
  std::vector<uint32_t> squares_;  // their numbers, from 1; x fastest
  std::vector<uint32_t> blocks_;   // their numbers, from 1, by square; x fastest, then y
  std::vector<uint32_t> words_;    // kWords for each block: by z, then two for its rows
  std::vector<Column> columns_;    // by square, as the blocks of a layer
};

/// Looks up lines on the way of a ray, one after the other, which are a block long at most along
/// each axis. `falls` has bit 0 for x and bit 1 for y that fall along the ray.
class CrossedCells::Way {
 public:
  Way(const CrossedCells& cells, uint32_t falls) : cells_(cells), falls_(falls) {}
  /// Whether beams crossed all cells of the line between two cells. The answer may be no although
  /// they did.
  bool surely_crossed(const Cell3& from, const Cell3& to) {
    const int log_square = 3 + cells_.log_side_;
    if (!columns_ || ((from.x ^ last_.x) | (from.y ^ last_.y)) >> log_square != 0) {
      const size_t square = cells_.square(from.x, from.y);
      columns_ = &cells_.columns_[square << 2 * cells_.log_side_];
      last_ = from;
    }
    const Column& column = columns_[cells_.in_square(from.x, from.y)];
    const Layers& all = column.crossed[falls_];
    const int32_t low = std::min(from.z, to.z), high = std::max(from.z, to.z);
    return (low >= all.first && high <= all.last) || low > column.above[falls_];
  }

 private:
  const CrossedCells& cells_;
  uint32_t falls_;
  Cell3 last_{};                     // the cell of the call before
  const Column* columns_ = nullptr;  // those of its square
};

}  // namespace underbrush::trace
