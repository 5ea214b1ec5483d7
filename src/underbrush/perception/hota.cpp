#include "underbrush/perception/hota.hpp"

#include <algorithm>
#include <cmath>

namespace underbrush::perception {
namespace {

constexpr double kStep = 0.05;  // Between thresholds.
constexpr double kRounding = 1e-9;

// The number of an identifier, counted from 0, with one cycle more.
size_t number_of(uint64_t id, std::map<uint64_t, size_t>& ids, std::vector<double>& cycles) {
  const size_t n = ids.emplace(id, ids.size()).first->second;
  cycles.resize(std::max(cycles.size(), n + 1), 0);
  ++cycles[n];
  return n;
}

}  // namespace

void HotaCounts::add(const ObjectList& reference, const ObjectList& list, bool ignore_unmatched) {
  const auto similarity = [&](const TrackedObject& a, const TrackedObject& b) {
    return std::max(0.0, 1 - (a.box.centre_m - b.box.centre_m).head<2>().norm() / zero_m_);
  };
  Cycle cycle;
  std::vector<const TrackedObject*> others;
  for (const TrackedObject& o : list.objects) {
    const bool is_near = std::any_of(reference.objects.begin(), reference.objects.end(),
                                     [&](const TrackedObject& r) { return similarity(r, o) > 0; });
    if (is_near || !ignore_unmatched) others.push_back(&o);
  }
  for (const TrackedObject& r : reference.objects) {
    cycle.reference.push_back(number_of(r.id, reference_ids_, reference_cycles_));
    for (const TrackedObject* o : others) cycle.similarity.push_back(similarity(r, *o));
  }
  for (const TrackedObject* o : others) {
    cycle.list.push_back(number_of(o->id, list_ids_, list_cycles_));
  }
  const size_t rows = cycle.reference.size(), columns = cycle.list.size();
  std::vector<double> row(rows, 0), column(columns, 0);
  for (size_t k = 0; k < cycle.similarity.size(); ++k) {
    row[k / columns] += cycle.similarity[k];
    column[k % columns] += cycle.similarity[k];
  }
  likely_.resize(reference_ids_.size());
  for (size_t k = 0; k < cycle.similarity.size(); ++k) {
    const double s = cycle.similarity[k], all = row[k / columns] + column[k % columns] - s;
    if (s > 0) likely_[cycle.reference[k / columns]][cycle.list[k % columns]] += s / all;
  }
  cycles_.push_back(std::move(cycle));
}

// The share of the cycles of both numbers in which they are together.
double HotaCounts::agreement(size_t reference, size_t list, double together) const {
  return together / (reference_cycles_[reference] + list_cycles_[list] - together);
}

Hota HotaCounts::result() const {
  std::array<double, kThresholds> pairs{};
  std::vector<Counts> together(kThresholds, Counts(reference_ids_.size()));
  double rows = 0, columns = 0;
  Assignment assignment;
  std::vector<double> cost;
  for (const Cycle& c : cycles_) {
    rows += double(c.reference.size());
    columns += double(c.list.size());
    cost.clear();
    for (size_t k = 0; k < c.similarity.size(); ++k) {
      const size_t r = c.reference[k / c.list.size()], o = c.list[k % c.list.size()];
      const auto at = likely_[r].find(o);
      cost.push_back(at == likely_[r].end() ? 1
                                            : 1 - c.similarity[k] * agreement(r, o, at->second));
    }
    const auto partner = assignment.solve(cost, c.reference.size(), c.list.size(), 1);
    for (size_t r = 0; r < partner.size(); ++r) {
      if (partner[r] == kUnassigned) continue;
      const double s = c.similarity[r * c.list.size() + partner[r]];
      for (size_t t = 0; t < kThresholds && s >= kStep * double(t + 1) - kRounding; ++t) {
        ++pairs[t];
        ++together[t][c.reference[r]][c.list[partner[r]]];
      }
    }
  }
  Hota out;
  for (size_t t = 0; t < kThresholds; ++t) {
    double sum = 0;
    for (size_t r = 0; r < together[t].size(); ++r) {
      for (const auto& [o, n] : together[t][r]) sum += n * agreement(r, o, n);
    }
    const double all = rows + columns - pairs[t];
    const double detection = all > 0 ? pairs[t] / all : 1;
    const double association = pairs[t] > 0 ? sum / pairs[t] : all > 0 ? 0 : 1;
    out.detection += detection / kThresholds;
    out.association += association / kThresholds;
    out.hota += std::sqrt(detection * association) / kThresholds;
  }
  return out;
}

}  // namespace underbrush::perception
