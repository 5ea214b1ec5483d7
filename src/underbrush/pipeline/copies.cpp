#include "underbrush/pipeline/copies.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

#include "underbrush/pipeline/row_filter.hpp"

namespace underbrush::pipeline {
namespace {

/// The points that are no copies, in their order.
std::vector<size_t> without_copies(const PointScan& scan) {
  std::vector<size_t> order(scan.size());
  std::iota(order.begin(), order.end(), size_t(0));
  const bool apart =
      scan.time_s.empty() || scan.extra.contains("target_index") ||
      scan.extra.contains("return_number") ||
      !std::ranges::all_of(scan.point, [](const Vec3f& p) { return p.allFinite() && !p.isZero(); });
  if (apart) return order;
  const auto key = [&](size_t i) {
    const Vec3f& p = scan.point[i];
    return std::tuple(scan.time_s[i], p.x(), p.y(), p.z(), scan.ring.empty() ? 0 : scan.ring[i]);
  };
  std::ranges::stable_sort(order, {}, key);
  const auto same = [&](size_t a, size_t b) { return key(a) == key(b); };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  std::ranges::sort(order);
  return order;
}

}  // namespace

double share_of_copies(const PointScan& scan) {
  if (scan.size() == 0) return 0;
  return 1 - double(without_copies(scan).size()) / double(scan.size());
}

size_t remove_copies(PointScan& scan) {
  const size_t all = scan.size();
  keep_rows(without_copies(scan), scan);
  return all - scan.size();
}

}  // namespace underbrush::pipeline
