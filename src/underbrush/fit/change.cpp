#include "underbrush/fit/change.hpp"

#include <cmath>
#include <vector>

#include "underbrush/core/cells.hpp"

namespace underbrush::fit {
namespace {

struct Counts {
  double hits = 0, misses = 0;
};

Counts independent(const Trials& t) {
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

/// Whether the share of hits of later trials is less.
bool went_down(const Trials& earlier, const Trials& later) {
  return double(later.hits) * (double(earlier.hits) + earlier.misses) <
         double(earlier.hits) * (double(later.hits) + later.misses);
}

bool is_free(uint64_t hits, uint64_t misses, const FreeSpace& free) {
  const double beams = double(hits) + double(misses);
  return beams >= free.beams && double(hits) < free.below * beams;
}

/// Sums over the ellipsoids of a cell, of which the share of hits went up, and went down.
struct NearbySums {
  double evidence[2] = {0, 0};
  uint64_t hits = 0, misses = 0;  // the later trials of changed ones that went down
};

using Cells = CellMap<Cell3, NearbySums>;

Cell3 cell_at(const elements::Ellipsoid& e) {
  return cell_of(Vec3(e.mean.cast<double>()), kChangeCellM);
}

/// The sums of the 27 cells about a cell, in a fixed order.
NearbySums about(const Cells& cells, const Cell3& centre) {
  NearbySums sum;
  for (int k = 0; k < 27; ++k) {
    const auto at =
        cells.find({centre.x + k % 3 - 1, centre.y + k / 3 % 3 - 1, centre.z + k / 9 - 1});
    if (at == cells.end()) continue;
    for (int way = 0; way < 2; ++way) sum.evidence[way] += at->second.evidence[way];
    sum.hits += at->second.hits;
    sum.misses += at->second.misses;
  }
  return sum;
}

}  // namespace

double change_evidence(const Trials& earlier, const Trials& later) {
  const Counts a = independent(earlier), b = independent(later);
  return log_marginal(a) + log_marginal(b) - log_marginal({a.hits + b.hits, a.misses + b.misses});
}

void add_trials(std::span<const elements::Ellipsoid> ellipsoids, std::span<const Trials> later,
                const FreeSpace& free, std::span<CurrentTrials> of) {
  std::vector<double> evidence(of.size());
  Cells cells;
  for (size_t i = 0; i < of.size(); ++i) {
    const Trials &before = of[i].trials, &now = later[i];
    if (before.hits + before.misses == 0 || now.hits + now.misses == 0) continue;
    evidence[i] = change_evidence(before, now);
    cells[cell_at(ellipsoids[i])].evidence[went_down(before, now)] += evidence[i];
  }
  for (size_t i = 0; i < of.size(); ++i) {
    const bool down = went_down(of[i].trials, later[i]);
    const bool agrees = evidence[i] > 0 || (down && later[i].hits == 0);
    of[i].changed = agrees && about(cells, cell_at(ellipsoids[i])).evidence[down] > kChangeEvidence;
    if (!of[i].changed || !down) continue;
    NearbySums& cell = cells.at(cell_at(ellipsoids[i]));
    cell.hits += later[i].hits;
    cell.misses += later[i].misses;
  }
  for (size_t i = 0; i < of.size(); ++i) {
    CurrentTrials& current = of[i];
    const bool is_met = later[i].hits + later[i].misses > 0;
    if (current.changed || !is_met) {
      const NearbySums sum = about(cells, cell_at(ellipsoids[i]));
      const bool down = !is_met || went_down(current.trials, later[i]);
      const bool is_gone = down && sum.evidence[true] > kChangeEvidence &&
                           is_free(sum.hits, sum.misses, free);
      if (!is_met && !is_gone) continue;
      current.changed = !is_met || current.changed;
      current.gone = is_gone;
      current.trials = later[i];
    } else {
      current.trials.hits += later[i].hits;
      current.trials.misses += later[i].misses;
      const double beams = double(current.trials.hits) + current.trials.misses;
      current.gone = current.gone && current.trials.hits <= free.below * beams;
    }
  }
}

}  // namespace underbrush::fit
