#include "underbrush/trace/crossed_cells.hpp"

#include <algorithm>
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

UNDERBRUSH_CLONES
uint32_t entered_cells(const StepCells& cells, const Cell3& last) {
  constexpr size_t kSteps = StepCells::kSteps;
  std::array<int32_t, kSteps> change{};
  const auto compare = [&](const std::array<int32_t, kSteps>& at, int32_t before) {
    change[0] |= at[0] ^ before;
    for (size_t k = 1; k < kSteps; ++k) change[k] |= at[k] ^ at[k - 1];
  };
  compare(cells.x, last.x);
  compare(cells.y, last.y);
  compare(cells.z, last.z);
  uint32_t out = 0;
  for (size_t k = 0; k < kSteps; ++k) out |= uint32_t(change[k] != 0) << k;
  return out;
}

UNDERBRUSH_CLONES
uint32_t drawn_at_most(double most, uint64_t key, const StepCells& cells) {
  // A draw is (b + 1/2) 2⁻⁵² with 52 random bits b.
  const auto limit = int64_t(std::min(most, 1.0) * 0x1p52);
  std::array<int64_t, StepCells::kSteps> below;
  for (size_t k = 0; k < StepCells::kSteps; ++k) {
    const uint64_t xy = mix64(uint64_t(uint32_t(cells.x[k])) << 32 | uint32_t(cells.y[k]));
    const uint64_t cell = mix64(xy + uint32_t(cells.z[k]));  // as CellHash
    const uint64_t bits = random_bits(mix64(key ^ cell), 0, Purpose::kUnknown);
    below[k] = int64_t(bits >> 12) <= limit;
  }
  uint32_t out = 0;
  for (size_t k = 0; k < StepCells::kSteps; ++k) out |= uint32_t(below[k]) << k;
  return out;
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
