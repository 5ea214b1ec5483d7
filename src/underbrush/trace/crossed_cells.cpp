#include "underbrush/trace/crossed_cells.hpp"

#include <bit>

#include "underbrush/core/clones.hpp"

namespace underbrush::trace {

using elements::ObservedBlock;

UNDERBRUSH_CLONES
void cells_of_steps(const Vec3& start, const Vec3& direction, double from_m, double step_m,
                    double cell_m, StepCells& cells) {
  const std::array<int32_t*, 3> out{cells.x.data(), cells.y.data(), cells.z.data()};
  for (int axis = 0; axis < 3; ++axis) {
    const double begin = start[axis], slope = direction[axis];
    for (int k = 0; k < StepCells::kSteps; ++k) {
      const double middle = from_m + (k + 0.5) * step_m;
      out[size_t(axis)][k] = cell_index(begin + middle * slope, cell_m);
    }
  }
}

CrossedCells::CrossedCells(const elements::ObservedSpace& space)
    : slots_(std::bit_ceil(2 * space.blocks.size() + 1)) {
  bits_.reserve(space.blocks.size());
  for (const ObservedBlock& b : space.blocks) {
    Bits& bits = bits_.emplace_back();
    for (size_t k = 0; k < ObservedBlock::kCells; ++k) {
      bits[k / 64] |= uint64_t(b.beams[k] > 0) << k % 64;
    }
    size_t at = CellHash()(b.at);
    while (slots_[at & (slots_.size() - 1)].number > 0) ++at;
    slots_[at & (slots_.size() - 1)] = {b.at, uint32_t(bits_.size())};
  }
}

}  // namespace underbrush::trace
