#include "underbrush/movers/mover_groups.hpp"

#include <algorithm>
#include <numeric>

namespace underbrush::movers {
namespace {

constexpr int32_t kReach = 2;  // Columns between returns that hang together.

/// Sets of returns that hang together (union–find with halved paths).
class Sets {
 public:
  explicit Sets(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(uint32_t a, uint32_t b) {
    parent_[std::max(find(a), find(b))] = std::min(find(a), find(b));
  }

 private:
  std::vector<uint32_t> parent_;
};

/// The returns of a scan by the cells of its image.
class Cells {
 public:
  Cells(const ScanImage& image, const std::vector<ScanReturn>& returns)
      : image_(image), place_(returns.size()), first_(size_t(image.rows() * image.columns()) + 1) {
    for (size_t i = 0; i < returns.size(); ++i) {
      place_[i] = image.place(returns[i].point);
      ++first_[image.index(place_[i].row, place_[i].column) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    item_.resize(returns.size());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (size_t i = 0; i < returns.size(); ++i) {
      item_[next[image.index(place_[i].row, place_[i].column)]++] = uint32_t(i);
    }
  }
  const ScanImage::Place& place(size_t i) const { return place_[i]; }
  /// Calls `see` with each return in the cells around, over the gap between two rings.
  template <class See>
  void around(size_t i, See&& see) const {
    const ScanImage::Place& at = place_[i];
    const int32_t reach = image_.gap_rows();
    for (int32_t row = std::max(0, at.row - reach);
         row <= std::min(image_.rows() - 1, at.row + reach); ++row) {
      for (int32_t step = -kReach; step <= kReach; ++step) {
        const int32_t column = (at.column + step + image_.columns()) % image_.columns();
        const size_t cell = image_.index(row, column);
        for (uint32_t k = first_[cell]; k < first_[cell + 1]; ++k) see(item_[k]);
      }
    }
  }

 private:
  const ScanImage& image_;
  std::vector<ScanImage::Place> place_;
  std::vector<uint32_t> first_, item_;
};

/// Candidates that hang together, and the returns beside them that stay.
struct Group {
  uint32_t candidates = 0, staying = 0;
  double solid = 0;
  void add(double share) {
    ++candidates;
    solid += share;
  }
  bool is_mover(const MoverOptions& options) const {
    return candidates >= options.least_points && solid >= options.least_solid * candidates &&
           candidates >= options.least_share * (candidates + staying);
  }
};

}  // namespace

std::vector<uint8_t> group_movers(const ScanImage& image, const std::vector<ScanReturn>& returns,
                                  const std::vector<Evidence>& evidence,
                                  const MoverOptions& options) {
  const Cells cells(image, returns);
  const auto n = uint32_t(returns.size());
  const auto distance = [&](uint32_t a, uint32_t b) {  // in tolerances of a range
    const double same = options.same_m + options.same_per_m * double(cells.place(a).range_m);
    return (returns[a].point - returns[b].point).norm() / same;
  };
  Sets sets(n);
  std::vector<uint32_t> staying_beside(n, n);  // the last candidate beside a return that stays
  for (uint32_t i = 0; i < n; ++i) {
    if (evidence[i].verdict != Verdict::kCandidate) continue;
    cells.around(i, [&](uint32_t k) {
      if (evidence[k].verdict == Verdict::kNone) return;
      const double d = distance(i, k);
      if (evidence[k].verdict == Verdict::kStays && d < 1) staying_beside[k] = i;
      if (evidence[k].verdict == Verdict::kCandidate && k < i && d < 2) sets.join(i, k);
    });
  }
  std::vector<Group> groups(n);
  for (uint32_t i = 0; i < n; ++i) {
    if (evidence[i].verdict == Verdict::kCandidate) groups[sets.find(i)].add(evidence[i].solid);
    if (staying_beside[i] < n) ++groups[sets.find(staying_beside[i])].staying;
  }
  std::vector<uint8_t> out(n);
  for (uint32_t i = 0; i < n; ++i) {
    if (evidence[i].verdict != Verdict::kCandidate) continue;
    if (!groups[sets.find(i)].is_mover(options)) continue;
    out[i] = 1;
    cells.around(i, [&](uint32_t k) {
      if (evidence[k].verdict == Verdict::kNone && distance(i, k) < 2) out[k] = 1;
    });
  }
  return out;
}

}  // namespace underbrush::movers
