#include "underbrush/update/change.hpp"

#include <cmath>
#include <vector>

#include "underbrush/core/cells.hpp"

namespace underbrush::update {
namespace {

struct Counts {
  double hits = 0, misses = 0;
};

Counts independent(const credit::Trials& t) {
  const double n = double(t.hits) + t.misses;
  const double share = n > 0 ? 1 / (1 + (n - 1) * kTrialCorrelation) : 0;
  return {t.hits * share, t.misses * share};
}

/// log B(h + 1, m + 1).
double log_marginal(const Counts& c) {
  int sign = 0;  // lgamma() itself writes a variable that threads share
  return lgamma_r(c.hits + 1, &sign) + lgamma_r(c.misses + 1, &sign) -
         lgamma_r(c.hits + c.misses + 2, &sign);
}

bool is_free(uint64_t hits, uint64_t misses, const FreeSpace& free) {
  const double beams = double(hits) + double(misses);
  return beams >= free.beams && double(hits) < free.below * beams;
}

/// The ways in which the share of hits can go.
enum Way { kUp, kDown };

/// Sums over the ellipsoids of a cell, by the way that they went.
struct NearbySums {
  double evidence[2] = {0, 0};
  uint64_t hits[2] = {0,
                      0};  // while it was, or is, less: earlier ones on the way up, else later ones
  uint64_t misses[2] = {0, 0};
};

using Cells = CellMap<Cell3, NearbySums>;

Cell3 cell_at(const elements::Ellipsoid& e) {
  return cell_of(Vec3(e.mean.cast<double>()), kChangeCellM);
}

/// The way of the share of hits; up where it stays.
Way way_of(const credit::Trials& earlier, const credit::Trials& later) {
  return double(later.hits) * (double(earlier.hits) + earlier.misses) <
                 double(earlier.hits) * (double(later.hits) + later.misses)
             ? kDown
             : kUp;
}

/// Whether an ellipsoid agrees that its place has changed.
bool agrees(double evidence, const credit::Trials& earlier, const credit::Trials& later) {
  return evidence > 0 || (later.hits == 0 && way_of(earlier, later) == kDown);
}

/// The sums of the 27 cells about a cell, in a fixed order.
NearbySums about(const Cells& cells, const Cell3& centre) {
  NearbySums sum;
  for (int k = 0; k < 27; ++k) {
    const auto at =
        cells.find({centre.x + k % 3 - 1, centre.y + k / 3 % 3 - 1, centre.z + k / 9 - 1});
    if (at == cells.end()) continue;
    for (const Way way : {kUp, kDown}) {
      sum.evidence[way] += at->second.evidence[way];
      sum.hits[way] += at->second.hits[way];
      sum.misses[way] += at->second.misses[way];
    }
  }
  return sum;
}

}  // namespace

double change_evidence(const credit::Trials& earlier, const credit::Trials& later) {
  const Counts a = independent(earlier), b = independent(later);
  return log_marginal(a) + log_marginal(b) - log_marginal({a.hits + b.hits, a.misses + b.misses});
}

void add_trials(std::span<const elements::Ellipsoid> ellipsoids,
                std::span<const credit::Trials> later, const FreeSpace& free,
                std::span<CurrentTrials> of) {
  std::vector<double> evidence(of.size());
  Cells cells;
  for (size_t i = 0; i < of.size(); ++i) {
    const credit::Trials &before = of[i].trials, &now = later[i];
    if (before.hits + before.misses == 0 || now.hits + now.misses == 0) continue;
    evidence[i] = change_evidence(before, now);
    const Way way = way_of(before, now);
    NearbySums& cell = cells[cell_at(ellipsoids[i])];
    cell.evidence[way] += evidence[i];
    if (!agrees(evidence[i], before, now)) continue;
    const credit::Trials& least = way == kDown ? now : before;
    cell.hits[way] += least.hits;
    cell.misses[way] += least.misses;
  }
  const auto has_turned = [&](const elements::Ellipsoid& e, Way way) {
    const NearbySums sum = about(cells, cell_at(e));
    return sum.evidence[way] > kPlaceEvidence && is_free(sum.hits[way], sum.misses[way], free);
  };
  for (size_t i = 0; i < of.size(); ++i) {
    CurrentTrials& current = of[i];
    const credit::Trials before = current.trials, &now = later[i];
    const bool is_met = now.hits + now.misses > 0;
    const Way way = is_met ? way_of(before, now) : kDown;
    const bool with_others =
        (!is_met || agrees(evidence[i], before, now)) && has_turned(ellipsoids[i], way);
    current.changed = with_others || evidence[i] > kChangeEvidence;
    if (current.changed) {
      current.gone = way == kDown && (with_others || is_free(now.hits, now.misses, free));
      current.trials = now;
    } else {
      current.trials = {before.hits + now.hits, before.misses + now.misses};
      const double beams = double(current.trials.hits) + current.trials.misses;
      current.gone = current.gone && current.trials.hits <= free.below * beams;
    }
  }
}

}  // namespace underbrush::update
