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
  const auto fill = [&](auto in_cells) {
    for (int axis = 0; axis < 3; ++axis) {
      const double begin = start[axis], slope = direction[axis];
      for (int k = 0; k < StepCells::kSteps; ++k) {
        const double middle = from_m + (k + 0.5) * step_m;
        out[size_t(axis)][k] = cell_index(in_cells(begin + middle * slope), 1);
      }
    }
  };
  // The inverse of a power of two is exact, and to multiply takes less than to divide.
  const bool is_power = (std::bit_cast<uint64_t>(cell_m) & ((uint64_t(1) << 52) - 1)) == 0;
  if (is_power) {
    fill([inverse = 1 / cell_m](double x) { return x * inverse; });
  } else {
    fill([cell_m](double x) { return x / cell_m; });
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

uint32_t CrossedCells::among(const StepCells& cells) const {
  constexpr size_t kSteps = StepCells::kSteps;
  uint32_t out = 0;
  Cell3 last{cells.x[0] ^ -1, 0, 0};
  const uint32_t* words = nullptr;  // of the block of the last step
  for (size_t k = 0; k < kSteps; ++k) {
    const Cell3 c = cells.of(int(k));
    if (((c.x ^ last.x) | (c.y ^ last.y) | (c.z ^ last.z)) >> 3 != 0) {
      words = &words_[blocks_[place(c.x, c.y, c.z)] * kWords];
      last = c;
    }
    out |= (words[(c.z & 7) << 1 | (c.y >> 2 & 1)] >> bit(c.x, c.y) & 1) << k;
  }
  return out;
}

CrossedCells::CrossedCells(const elements::ObservedSpace& space, const MatterAbove& matter)
    : squares_(4), words_(kWords) {
  constexpr size_t kMostSquares = 1 << 20;
  if (!space.blocks.empty()) {
    Cell3 low = space.blocks.front().at, high = low;
    for (const ObservedBlock& b : space.blocks) {
      low = {std::min(low.x, b.at.x), std::min(low.y, b.at.y), std::min(low.z, b.at.z)};
      high = {std::max(high.x, b.at.x), std::max(high.y, b.at.y), std::max(high.z, b.at.z)};
    }
    const auto squares = [&] {
      low_ = {low.x >> log_side_, low.y >> log_side_, low.z};
      size_ = {(high.x >> log_side_) - low_.x + 1, (high.y >> log_side_) - low_.y + 1,
               high.z - low.z + 1};
      return size_t(size_.x + 2) * size_t(size_.y + 2);
    };
    while (squares() > kMostSquares) ++log_side_;
    squares_.assign(squares(), 0);
  }
  const size_t of_layer = size_t(1) << 2 * log_side_;
  columns_.resize(of_layer);
  for (const ObservedBlock& b : space.blocks) {
    const int32_t i = (b.at.x >> log_side_) - low_.x + 1, j = (b.at.y >> log_side_) - low_.y + 1;
    uint32_t& number = squares_[size_t(j) * size_t(size_.x + 2) + size_t(i)];
    if (number > 0) continue;
    number = uint32_t(columns_.size() / of_layer);
    columns_.resize(columns_.size() + of_layer);
  }
  blocks_.resize(columns_.size() * size_t(size_.z + 2));
  words_.reserve((space.blocks.size() + 1) * kWords);
  for (const ObservedBlock& b : space.blocks) {
    const size_t first = words_.size();
    blocks_[place(kSide * b.at.x, kSide * b.at.y, kSide * b.at.z)] = uint32_t(first / kWords);
    words_.resize(first + kWords);
    for (size_t c = 0; c < ObservedBlock::kCells; ++c) {
      words_[first + c / 32] |= uint32_t(b.beams[c] > 0) << c % 32;
    }
  }
  if (matter) leave_out(space, matter);
  find_layers(space);
}

void CrossedCells::leave_out(const elements::ObservedSpace& space, const MatterAbove& matter) {
  std::array<Layers, size_t(kSide) * kSide> with;  // of the columns of cells of a column of blocks
  Layers every;                                    // the layers with matter in all of them
  const Column* last = nullptr;
  for (const ObservedBlock& b : space.blocks) {
    const int32_t x = kSide * b.at.x, y = kSide * b.at.y, z = kSide * b.at.z;
    Column& column = columns_[column_of(x, y)];
    if (&column != last) {
      column.top = INT32_MIN;
      every = {INT32_MIN, INT32_MAX};
      for (int32_t k = 0; k < kSide * kSide; ++k) {
        with[size_t(k)] = matter(x + k % kSide, y + k / kSide);
        column.top = std::max(column.top, with[size_t(k)].last);
        every = {std::max(every.first, with[size_t(k)].first),
                 std::min(every.last, with[size_t(k)].last)};
      }
      last = &column;
    }
    if (z >= every.first && z + kSide - 1 <= every.last) continue;
    uint32_t* words = &words_[blocks_[place(x, y, z)] * kWords];
    if (z > column.top) {
      std::fill_n(words, kWords, ~0u);
      continue;
    }
    for (int32_t c = 0; c < int32_t(ObservedBlock::kCells); ++c) {
      const Layers& in = with[size_t(c) % with.size()];
      const int32_t layer = z + c / (kSide * kSide);
      words[c / 32] |= uint32_t(layer < in.first || layer > in.last) << c % 32;
    }
  }
}

void CrossedCells::find_layers(const elements::ObservedSpace& space) {
  const int32_t bottom = kSide * low_.z, end = bottom + kSide * size_.z;
  const Column* last = nullptr;
  for (const ObservedBlock& b : space.blocks) {
    Column& column = columns_[column_of(kSide * b.at.x, kSide * b.at.y)];
    if (&column == last) continue;
    last = &column;
    for (int way = 0; way < 4; ++way) {
      const std::array<int32_t, 2> x{kSide * b.at.x, kSide * (b.at.x + ((way & 1) ? -1 : 1))},
          y{kSide * b.at.y, kSide * (b.at.y + ((way & 2) ? -1 : 1))};
      const auto is_full = [&](int32_t z) {
        for (int k = 0; k < 4; ++k) {
          const int32_t at_x = x[size_t(k & 1)], at_y = y[size_t(k >> 1)];
          if (z > columns_[column_of(at_x, at_y)].top) continue;
          const size_t first = blocks_[place(at_x, at_y, z)] * kWords + size_t(2 * (z & 7));
          if (words_[first] != ~0u || words_[first + 1] != ~0u) return false;
        }
        return true;
      };
      Layers run;
      Layers& best = column.crossed[size_t(way)];
      int32_t above = bottom - 1;
      for (int32_t z = bottom; z < end; ++z) {
        if (!is_full(z)) {
          run = {};
          above = z;
          continue;
        }
        run = {run.last < run.first ? z : run.first, z};
        if (run.last - run.first > best.last - best.first) best = run;
      }
      if (is_full(end)) column.above[size_t(way)] = above;
    }
  }
}

}  // namespace underbrush::trace
