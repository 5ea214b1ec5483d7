#include "underbrush/trace/crossed_cells.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "underbrush/core/clones.hpp"

namespace underbrush::trace {

using elements::ObservedBlock;

namespace {

constexpr size_t kSide = ObservedBlock::kSide;

/// The bytes that are not 0 as bits, for eight bytes.
uint32_t bits_of(const uint8_t* bytes) {
  constexpr uint64_t kLow = 0x7f7f7f7f7f7f7f7f, kOnes = 0x0101010101010101;
  uint64_t eight;
  std::memcpy(&eight, bytes, sizeof eight);
  eight = ((eight & kLow) + kLow) | eight;  // The highest bit of each byte is set.
  return uint32_t(((eight >> 7 & kOnes) * 0x0102040810204080) >> 56);
}

/// Adds such bits of a layer of a block to its two words.
void add_layer(const uint8_t* bytes, uint32_t* words) {
  for (uint32_t row = 0; row < kSide; ++row) {
    words[row / 4] |= bits_of(bytes + kSide * row) << 8 * (row % 4);
  }
}

/// Adds the cells of a block that lie below the first or above the last layer with matter. The
/// block begins with the layer z.
UNDERBRUSH_CLONES
void add_without_matter(const CrossedCells::ColumnLayers& with, int32_t z, uint32_t* words) {
  for (size_t k = 0; k < kSide; ++k) {
    const int32_t layer = z + int32_t(k);
    std::array<uint8_t, kSide * kSide> without;
    for (size_t c = 0; c < without.size(); ++c) {
      without[c] = uint8_t((layer < with[c].first) | (layer > with[c].last));
    }
    add_layer(without.data(), words + 2 * k);
  }
}

}  // namespace

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
    for (size_t k = 0; k < size_t(kSide); ++k) {
      add_layer(&b.beams[k * kSide * kSide], &words_[first + 2 * k]);
    }
  }
  if (matter) leave_out(space, matter);
  find_layers(space);
}

void CrossedCells::leave_out(const elements::ObservedSpace& space, const MatterAbove& matter) {
  ColumnLayers with;
  Layers every;  // the layers with matter in all of them
  const Column* last = nullptr;
  for (const ObservedBlock& b : space.blocks) {
    const int32_t x = kSide * b.at.x, y = kSide * b.at.y, z = kSide * b.at.z;
    Column& column = columns_[column_of(x, y)];
    if (&column != last) {
      with = matter(x, y);
      column.top = INT32_MIN;
      every = {INT32_MIN, INT32_MAX};
      for (const Layers& in : with) {
        column.top = std::max(column.top, in.last);
        every = {std::max(every.first, in.first), std::min(every.last, in.last)};
      }
      last = &column;
    }
    if (z >= every.first && z + kSide - 1 <= every.last) continue;
    uint32_t* words = &words_[blocks_[place(x, y, z)] * kWords];
    if (z > column.top) {
      std::fill_n(words, kWords, ~0u);
    } else {
      add_without_matter(with, z, words);
    }
  }
}

std::vector<uint8_t> CrossedCells::crossed_layers(const elements::ObservedSpace& space) const {
  const size_t bytes = size_t(size_.z) + 1;
  std::vector<uint8_t> out(columns_.size() * bytes);
  size_t last = 0;
  for (const ObservedBlock& b : space.blocks) {
    const int32_t x = kSide * b.at.x, y = kSide * b.at.y, z = kSide * b.at.z;
    const size_t number = column_of(x, y);
    uint8_t* column = &out[number * bytes];
    if (number != last) {
      for (size_t k = 0; k < bytes; ++k) {
        const int64_t below = int64_t(columns_[number].top) + 1 - kSide * (low_.z + int64_t(k));
        column[k] = uint8_t(0xff << std::clamp<int64_t>(below, 0, kSide));
      }
      last = number;
    }
    const uint32_t* words = &words_[blocks_[place(x, y, z)] * kWords];
    for (int k = 0; k < kSide; ++k) {
      column[b.at.z - low_.z] |= uint8_t((words[2 * k] & words[2 * k + 1]) == ~0u) << k;
    }
  }
  return out;
}

void CrossedCells::find_layers(const elements::ObservedSpace& space) {
  const size_t bytes = size_t(size_.z) + 1;
  const std::vector<uint8_t> crossed = crossed_layers(space);
  const Column* last = nullptr;
  for (const ObservedBlock& b : space.blocks) {
    Column& column = columns_[column_of(kSide * b.at.x, kSide * b.at.y)];
    if (&column == last) continue;
    last = &column;
    for (int way = 0; way < 4; ++way) {
      const int32_t x = kSide * b.at.x, y = kSide * b.at.y,
                    next_x = x + ((way & 1) ? -kSide : kSide),
                    next_y = y + ((way & 2) ? -kSide : kSide);
      const auto layers_at = [&](int32_t i, int32_t j) {
        return &crossed[column_of(i, j) * bytes];
      };
      const std::array<const uint8_t*, 4> of{layers_at(x, y), layers_at(next_x, y),
                                             layers_at(x, next_y), layers_at(next_x, next_y)};
      const auto all = [&](int32_t k) { return of[0][k] & of[1][k] & of[2][k] & of[3][k]; };
      Layers run;
      Layers& best = column.crossed[size_t(way)];
      int32_t above = kSide * low_.z - 1;
      const auto add = [&](bool is_crossed, int32_t z, int32_t count) {
        if (!is_crossed) {
          run = {};
          above = z + count - 1;
          return;
        }
        run = {run.last < run.first ? z : run.first, z + count - 1};
        if (run.last - run.first > best.last - best.first) best = run;
      };
      for (int32_t k = 0; k < size_.z; ++k) {
        const int32_t z = kSide * (low_.z + k), layers = all(k);
        if (layers == 0 || layers == 0xff) {
          add(layers != 0, z, kSide);
        } else {
          for (int i = 0; i < kSide; ++i) add(layers >> i & 1, z + i, 1);
        }
      }
      if (all(size_.z) & 1) column.above[size_t(way)] = above;
    }
  }
}

}  // namespace underbrush::trace
