#include "underbrush/calibrate/observed_map.hpp"

#include <algorithm>

#include "underbrush/trace/crossed_cells.hpp"

namespace underbrush::calibrate {

using elements::ObservedBlock;

void ObservedMap::add(const Vec3& origin, const Vec3& direction, double from_m, double to_m) {
  constexpr int kBatch = trace::StepCells::kSteps;
  const double step = 0.5 * cell_m_;
  Cell3 last{INT32_MAX, 0, 0};
  trace::StepCells cells;
  double t = from_m;
  for (; t + kBatch * step < to_m; t += kBatch * step) {
    trace::cells_of_steps(origin, direction, t - 0.5 * step, step, cell_m_, cells);
    for (int k = 0; k < kBatch; ++k) add(cells.of(k), last);
  }
  for (;; t += step) {
    add(cell_of(Vec3(origin + std::min(t, to_m) * direction), cell_m_), last);
    if (t >= to_m) return;
  }
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

void ObservedMap::add(const Cell3& cell, Cell3& last) {
  if (cell == last) return;
  last = cell;
  const Cell3 of = ObservedBlock::of(cell);
  if (!block_ || !(block_->at == of)) block_ = &block_at(of);
  uint8_t& n = block_->beams[ObservedBlock::index(cell)];
  if (n < 255) ++n;
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
