#include "underbrush/primitives/run_graph.hpp"

#include <array>
#include <numeric>
#include <tuple>

#include "underbrush/core/cells.hpp"

namespace underbrush::primitives {
namespace {

constexpr double kBaseM = 0.2;  // side of the columns that points are gathered in

int32_t floor_div(int32_t a, int32_t b) { return (a >= 0 ? a : a - b + 1) / b; }

}  // namespace

RunGraph::RunGraph(double cell_m, double gap_m)
    : base_m_(cell_m > 0 ? cell_m : kBaseM),
      cell_m_(base_m_),
      gap_m_(gap_m),
      is_cell_given_(cell_m > 0) {}

bool RunGraph::before(const Bin& a, const Bin& b) {
  return std::tie(a.y, a.x, a.z) < std::tie(b.y, b.x, b.z);
}

// Sorts and adds up bins of one place.
void RunGraph::merge(std::vector<Bin>& bins) {
  std::sort(bins.begin(), bins.end(), before);
  size_t n = 0;
  for (const Bin& b : bins) {
    if (n && !before(bins[n - 1], b)) {
      bins[n - 1].points += b.points;
      bins[n - 1].top_m = std::max(bins[n - 1].top_m, b.top_m);
    } else {
      bins[n++] = b;
    }
  }
  bins.resize(n);
}

void RunGraph::add(std::span<const Vec3f> points) {
  const double side = base_m_;
  constexpr float kFar = 1e6f;
  for (const Vec3f& p : points) {
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kFar) continue;
    bins_.push_back({int32_t(std::floor(double(p.y()) / side)),
                     int32_t(std::floor(double(p.x()) / side)),
                     int32_t(std::floor(double(p.z()) / kLayerM)), 1, p.z()});
  }
  if (bins_.size() > 2 * merged_ + (1 << 22)) {
    merge(bins_);
    merged_ = bins_.size();
  }
}

void RunGraph::build() {
  merge(bins_);
  choose_cell();
  make_runs();
}

// A column should hold two points or more where there are any.
void RunGraph::choose_cell() {
  cells_ = 1;
  if (!is_cell_given_ && !bins_.empty()) {
    CellMap<Cell2, uint32_t> square;  // of 1 m
    for (const Bin& b : bins_) square[{floor_div(b.x, 5), floor_div(b.y, 5)}] += b.points;
    std::vector<uint32_t> counts;
    counts.reserve(square.size());
    for (const auto& [at, n] : square) counts.push_back(n);
    std::nth_element(counts.begin(), counts.begin() + long(counts.size() / 2), counts.end());
    const double per_m2 = counts[counts.size() / 2];
    cells_ = int32_t(std::clamp(std::round(std::sqrt(2 / per_m2) / kBaseM), 2.0, 5.0));
  }
  cell_m_ = base_m_ * cells_;
  if (gap_m_ <= 0) gap_m_ = is_sparse() ? 12 : 1;
  for (Bin& b : bins_) b.x = floor_div(b.x, cells_), b.y = floor_div(b.y, cells_);
  merge(bins_);
}

void RunGraph::make_runs() {
  const auto gap = int32_t(std::lround(gap_m_ / kLayerM));
  for (const Bin& b : bins_) {
    if (runs_.empty() || runs_.back().y != b.y || runs_.back().x != b.x ||
        b.z - runs_.back().high > gap) {
      runs_.push_back({b.y, b.x, b.z, b.z, 0, 0});
    }
    runs_.back().high = b.z;
    runs_.back().points += b.points;
    runs_.back().top_m = b.top_m;
  }
  bins_ = {};
  if (runs_.empty()) return;
  first_row_ = runs_.front().y;
  row_begin_.assign(size_t(runs_.back().y - first_row_) + 2, 0);
  for (const Run& r : runs_) ++row_begin_[size_t(r.y - first_row_) + 1];
  std::partial_sum(row_begin_.begin(), row_begin_.end(), row_begin_.begin());
}

std::span<const Run> RunGraph::column(int32_t x, int32_t y) const {
  const int64_t row = int64_t(y) - first_row_;
  if (row < 0 || row + 1 >= int64_t(row_begin_.size())) return {};
  const auto begin = runs_.begin() + row_begin_[size_t(row)];
  const auto end = runs_.begin() + row_begin_[size_t(row) + 1];
  const auto less = [](const Run& r, int32_t at) { return r.x < at; };
  const auto more = [](int32_t at, const Run& r) { return at < r.x; };
  const auto from = std::lower_bound(begin, end, x, less);
  return {from, std::upper_bound(from, end, x, more)};
}

uint32_t RunGraph::run_at(const Vec3f& p) const {
  if (!p.allFinite()) return kNone;
  const auto at = [&](float v) {
    return floor_div(int32_t(std::floor(double(v) / base_m_)), cells_);
  };
  const auto z = int32_t(std::floor(double(p.z()) / kLayerM));
  for (const Run& r : column(at(p.x()), at(p.y()))) {
    if (z >= r.low && z <= r.high) return index_of(r);
  }
  return kNone;
}

}  // namespace underbrush::primitives
