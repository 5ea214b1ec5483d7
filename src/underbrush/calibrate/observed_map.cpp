#include "underbrush/calibrate/observed_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "underbrush/trace/crossed_cells.hpp"

namespace underbrush::calibrate {

using elements::ObservedBlock;

void ObservedMap::add(const Vec3& origin, const Vec3& direction, double from_m, double to_m) {
  constexpr int kBatch = trace::StepCells::kSteps;
  const double step = 0.5 * cell_m_;
  Cell3 last{INT32_MAX, 0, 0};
  trace::StepCells cells;
  for (double t = from_m; t < to_m; t += kBatch * step) {
    trace::cells_of_steps(origin, direction, t - 0.5 * step, step, cell_m_, cells);
    const double left = (to_m - t) / step;
    const int count = left < kBatch ? int(std::ceil(left)) : kBatch;
    uint32_t entered = trace::entered_cells(cells, last) & ((1u << count) - 1);
    for (; entered > 0; entered &= entered - 1) add(cells.of(std::countr_zero(entered)));
    last = cells.of(count - 1);
  }
  const Cell3 end = cell_of(Vec3(origin + to_m * direction), cell_m_);
  if (!(end == last)) add(end);
}

void ObservedMap::add(const ObservedMap& other) {
  for (const auto& [at, block] : other.blocks_) {
    ObservedBlock& sum = block_at(at);
    for (size_t k = 0; k < ObservedBlock::kCells; ++k) {
      sum.beams[k] = uint8_t(std::min(255, sum.beams[k] + block->beams[k]));
    }
  }
}

elements::ObservedSpace ObservedMap::space() const {
  elements::ObservedSpace out;
  out.cell_m = cell_m_;
  for (const auto& [at, block] : blocks_) out.blocks.push_back(*block);
  std::sort(out.blocks.begin(), out.blocks.end(),
            [](const ObservedBlock& a, const ObservedBlock& b) { return a.at < b.at; });
  return out;
}

void ObservedMap::add(const Cell3& cell) {
  const Cell3 of = ObservedBlock::of(cell);
  const auto place = size_t((of.x & 7) | (of.y & 7) << 3 | (of.z & 3) << 6);
  ObservedBlock*& block = recent_[place];
  if (!block || !(block->at == of)) block = &block_at(of);
  uint8_t& n = block->beams[ObservedBlock::index(cell)];
  n = uint8_t(n + (n < 255));
}

ObservedBlock& ObservedMap::block_at(const Cell3& at) {
  auto& place = blocks_[at];
  if (!place) {
    place = std::make_unique<ObservedBlock>();
    place->at = at;
  }
  return *place;
}

}  // namespace underbrush::calibrate
