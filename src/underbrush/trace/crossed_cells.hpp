/// \file
/// The cells of a map that beams crossed, for look-ups along rays.
#pragma once
#include <array>
#include <cstdint>
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

/// The cells of a map of observed space that a beam crossed: a bit for each cell, and the blocks in
/// a hash table with linear probing.
class CrossedCells {
 public:
  /// The bits of a block by z, and of a layer by y and x.
  using Bits = std::array<uint64_t, elements::ObservedBlock::kSide>;
  /// The block of the look-up before, which is that of most look-ups along a ray.
  struct Block {
    Cell3 at{INT32_MAX, 0, 0};
    const Bits* bits = nullptr;  ///< Null where the map has no such block.
  };

  explicit CrossedCells(const elements::ObservedSpace& space);

  /// Whether a beam crossed a cell.
  bool holds(const Cell3& cell) const {
    Block block;
    return holds(cell, block);
  }
  /// Whether a beam crossed a cell, where `block` is that of the call before.
  bool holds(const Cell3& cell, Block& block) const {
    const Cell3 at = elements::ObservedBlock::of(cell);
    if (!(at == block.at)) block = {at, find(at)};
    return block.bits &&
           ((*block.bits)[size_t(cell.z & 7)] >> (8 * (cell.y & 7) + (cell.x & 7)) & 1);
  }
  /// Whether beams crossed the cells of all steps.
  bool hold(const StepCells& cells, Block& block) const {
    for (int k = 0; k < StepCells::kSteps; ++k) {
      if (!holds(cells.of(k), block)) return false;
    }
    return true;
  }

 private:
  struct Slot {
    Cell3 at;
    uint32_t number;  // of the bits, from 1; 0 for an empty slot
  };

  const Bits* find(const Cell3& block) const {
    for (size_t k = CellHash()(block);; ++k) {
      const Slot& slot = slots_[k & (slots_.size() - 1)];
      if (slot.number == 0) return nullptr;
      if (slot.at == block) return &bits_[slot.number - 1];
    }
  }

  std::vector<Slot> slots_;  // a power of two of them, of which at most half are taken
  std::vector<Bits> bits_;
};

}  // namespace underbrush::trace
