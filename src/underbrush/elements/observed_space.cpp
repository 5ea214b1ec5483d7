#include "underbrush/elements/observed_space.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {
namespace {

template <size_t kCount>
size_t interval_of(const std::array<double, kCount>& edges, double value) {
  return size_t(std::upper_bound(edges.begin(), edges.end(), value) - edges.begin());
}

void add_beams(ObservedBlock& to, const ObservedBlock& from) {
  for (size_t k = 0; k < ObservedBlock::kCells; ++k) {
    to.beams[k] = uint8_t(std::min(255, int(to.beams[k]) + int(from.beams[k])));
  }
}

/// Whether the blocks lie so near to each other that a table of all places between them fits in
/// memory.
bool is_near(const std::vector<ObservedBlock>& blocks) {
  constexpr int32_t kMost[] = {1 << 16, 1 << 16, 1 << 12}, kFarthest = 1 << 25;
  if (blocks.empty()) return true;
  Cell3 low = blocks.front().at, high = low;
  for (const ObservedBlock& b : blocks) {
    low = {std::min(low.x, b.at.x), std::min(low.y, b.at.y), std::min(low.z, b.at.z)};
    high = {std::max(high.x, b.at.x), std::max(high.y, b.at.y), std::max(high.z, b.at.z)};
  }
  const auto fits = [](int32_t from, int32_t to, int32_t most) {
    return from >= -kFarthest && to <= kFarthest && to - from < most;
  };
  return fits(low.x, high.x, kMost[0]) && fits(low.y, high.y, kMost[1]) &&
         fits(low.z, high.z, kMost[2]);
}

}  // namespace

size_t ObservedSpace::height_interval(double height_m) { return interval_of(kHeightsM, height_m); }

size_t ObservedSpace::range_interval(double range_m) { return interval_of(kRangesM, range_m); }

void ObservedSpace::add(const ObservedSpace& other) {
  require(cell_m == other.cell_m, "observed space: the maps have different cells");
  std::vector<ObservedBlock> all;
  all.reserve(blocks.size() + other.blocks.size());
  auto a = blocks.begin();
  for (const ObservedBlock& b : other.blocks) {
    for (; a != blocks.end() && a->at < b.at; ++a) all.push_back(*a);
    all.push_back(b);
    if (a != blocks.end() && a->at == b.at) add_beams(all.back(), *a++);
  }
  all.insert(all.end(), a, blocks.end());
  blocks = std::move(all);
  std::map<Cell2, uint32_t> beams;
  for (const std::vector<LostBeams>* part : {&std::as_const(lost), &other.lost}) {
    for (const LostBeams& l : *part) beams[l.at] += l.beams;
  }
  lost.clear();
  for (const auto& [at, n] : beams) lost.push_back({at, n});
  top_m = std::max(top_m, other.top_m);
}

void ObservedSpace::check() const {
  require(std::isfinite(top_m), "observed space: its top must be a finite height");
  require(std::isfinite(cell_m) && cell_m > 0, "observed space: its cells must have a size");
  for (size_t k = 1; k < blocks.size(); ++k) {
    require(blocks[k - 1].at < blocks[k].at, "observed space: its blocks are not in order");
  }
  require(is_near(blocks), "observed space: a block is too far from the others");
  for (size_t k = 1; k < lost.size(); ++k) {
    require(lost[k - 1].at < lost[k].at, "observed space: its lost beams are not in order");
  }
  for (const float p : ground_returns) {
    require(p >= 0 && p <= 1, "observed space: a share of returns must be in [0, 1]");
  }
  for (const auto& row : density_per_m) {
    for (const float x : row) {
      require(std::isfinite(x) && x >= 0,
              "observed space: a density is not a number of at least 0");
    }
  }
}

}  // namespace underbrush::elements
