#include "underbrush/primitives/choose.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/primitives/adapt.hpp"

namespace underbrush::primitives {

using elements::Class;

namespace {

/// The middle of the bottom, in which two boxes agree when one takes the place of the other.
Vec3 foot_of(const Box& box) {
  return {0.5 * (box.min.x() + box.max.x()), 0.5 * (box.min.y() + box.max.y()), box.min.z()};
}

/// The mean square of the distances between the places of two bodies that stand upon each other,
/// m².
double square_distance(const PointLayers& a, const Vec3& foot_a, const PointLayers& b,
                       const Vec3& foot_b) {
  const Vec3 shift = foot_b - foot_a;
  double sum = 0;
  for (size_t l = 0; l < a.z.size(); ++l) {
    for (size_t q = 0; q < a.x[l].size(); ++q) {
      sum += (Vec3(b.x[l][q] - a.x[l][q], b.y[l][q] - a.y[l][q], b.z[l] - a.z[l]) - shift)
                 .squaredNorm();
    }
  }
  return sum / double(a.z.size() * a.x[0].size());
}

/// The logarithm of the returns per metre in a box, near 0 where there are few beams.
double log_density(const BoxBeams& b) {
  constexpr double kPrior = 2;
  return std::log((b.returns[0] + b.returns[1] + b.returns[2] + kPrior) /
                  (b.path_m[0] + b.path_m[1] + b.path_m[2] + kPrior));
}
double matter_difference(const BoxBeams& a, const BoxBeams& b) {
  return a.known() && b.known() ? std::abs(log_density(a) - log_density(b)) : 0;
}

}  // namespace

Chooser::Chooser(const PrimitiveSet& set, Choice choice, size_t nearest)
    : set_(set), choice_(choice), nearest_(nearest) {
  for (uint32_t k = 0; k < set.entries.size(); ++k) by_class_[set.entries[k].label].push_back(k);
}

const std::vector<uint32_t>& Chooser::candidates(Class c) {
  auto& found = by_class_[c];
  if (!found.empty()) return found;
  auto& kind = by_kind_[elements::kind_of(c)];
  if (kind.empty()) {
    for (uint32_t k = 0; k < set_.entries.size(); ++k) {
      if (elements::kind_of(set_.entries[k].label) == elements::kind_of(c)) kind.push_back(k);
    }
  }
  return kind;
}

double Chooser::cost(uint32_t entry, const PlacedObject& o) const {
  const PrimitiveEntry& e = set_.entries[entry];
  const double box_m = (e.box.size() - o.box.size()).norm();
  if (choice_ != Choice::kBest) return box_m;
  if (!can_adapt(e, o)) return box_m;
  const double points_m =
      std::sqrt(square_distance(o.layers, foot_of(o.box), e.layers, foot_of(e.box)));
  return box_m + kPointsWeight * points_m + kMatterWeightM * matter_difference(e.beams, o.beams);
}

bool Chooser::stands_near(uint32_t entry, const Vec3& position) const {
  const auto [x, y] = cell_of(position.x(), position.y(), kVarietyM);
  for (int k = 0; k < 9; ++k) {
    const auto cell = placed_.find(Cell2{x + k % 3 - 1, y + k / 3 - 1});
    if (cell == placed_.end()) continue;
    for (const auto& [other, at] : cell->second) {
      if (other == entry && (at - position.head<2>()).norm() < kVarietyM) return true;
    }
  }
  return false;
}

void Chooser::forget_below(double y_m) {
  const int32_t least = cell_index(y_m, kVarietyM) - 1;
  std::erase_if(placed_, [&](const auto& cell) { return cell.first.y < least; });
}

uint32_t Chooser::choose(const std::vector<uint32_t>& from, const PlacedObject& o, double draw) {
  const auto drawn = [&](size_t n) { return std::min(n - 1, size_t(double(n) * draw)); };
  if (choice_ == Choice::kRandom) return from[drawn(from.size())];
  order_.clear();
  for (const uint32_t k : from) order_.emplace_back(cost(k, o), k);
  const auto begin = order_.begin();
  if (choice_ == Choice::kBox) {
    const auto at = begin + long(drawn(std::min(nearest_, from.size())));
    std::nth_element(begin, at, order_.end());
    return at->second;
  }
  std::sort(begin, order_.end());
  const double most = order_[0].first + kFitsM;
  std::vector<uint32_t> fit;
  for (const auto& [cost_m, k] : order_) {
    if (fit.size() == nearest_ || cost_m > most) break;
    if (!stands_near(k, o.position)) fit.push_back(k);
  }
  const uint32_t chosen = fit.empty() ? order_[0].second : fit[drawn(fit.size())];
  placed_[cell_of(o.position.x(), o.position.y(), kVarietyM)].emplace_back(chosen,
                                                                           o.position.head<2>());
  return chosen;
}

}  // namespace underbrush::primitives
