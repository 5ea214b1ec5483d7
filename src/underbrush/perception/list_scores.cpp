#include "underbrush/perception/list_scores.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "underbrush/core/check.hpp"
#include "underbrush/perception/assignment.hpp"

namespace underbrush::perception {
namespace {

double distance(const TrackedObject& a, const TrackedObject& b) {
  return (a.box.centre_m - b.box.centre_m).head<2>().norm();
}

// The list nearest in time.
const ObjectList* nearest(std::span<const ObjectList> lists, double time_s, double tolerance_s) {
  const auto after = std::lower_bound(lists.begin(), lists.end(), time_s,
                                      [](const ObjectList& l, double t) { return l.time_s < t; });
  const ObjectList* best = after == lists.end() ? nullptr : &*after;
  if (after != lists.begin()) {
    const ObjectList* before = &*(after - 1);
    if (!best || time_s - before->time_s < best->time_s - time_s) best = before;
  }
  return best && std::abs(best->time_s - time_s) <= tolerance_s ? best : nullptr;
}

/// Compares cycle by cycle.
class Comparison {
 public:
  Comparison(const ListScoreOptions& options, ListScore& score)
      : options_(options), score_(score), hota_(options.hota_zero_m) {}

  void add(const ObjectList& reference, const ObjectList& list) {
    const size_t rows = reference.objects.size(), columns = list.objects.size();
    cost_.clear();
    for (const TrackedObject& r : reference.objects) {
      for (const TrackedObject& o : list.objects) {
        const double d = distance(r, o);
        cost_.push_back(d <= options_.gate_m ? d : std::numeric_limits<double>::infinity());
      }
    }
    const auto partner = assignment_.solve(cost_, rows, columns, options_.gate_m + 1);
    std::vector<uint8_t> taken(columns, 0);
    for (size_t r = 0; r < rows; ++r) {
      const TrackedObject* found = partner[r] == kUnassigned ? nullptr : &list.objects[partner[r]];
      if (found) taken[partner[r]] = 1;
      add(reference.objects[r], found, reference);
    }
    const auto matched = size_t(std::count(taken.begin(), taken.end(), 1));
    if (!options_.ignore_unmatched) score_.unmatched += columns - matched;
    ospa_ += ospa(reference, list, taken);
    hota_.add(reference, list, options_.ignore_unmatched);
    ++score_.cycles;
  }

  void finish() {
    const double n = double(std::max<size_t>(score_.found, 1));
    score_.position_mean_m = sum_ / n;
    score_.position_rms_m = std::sqrt(squares_ / n);
    score_.yaw_mean_rad = yaw_ / n;
    score_.ospa_m = ospa_ / double(std::max<size_t>(score_.cycles, 1));
    score_.hota = hota_.result();
    for (auto& [id, followed] : followed_) score_.followed.push_back(std::move(followed));
  }

 private:
  void add(const TrackedObject& r, const TrackedObject* found, const ObjectList& reference) {
    const Vec3 from = reference.world_from_vehicle.translation;
    const double range = (r.box.centre_m - from).head<2>().norm();
    const auto bin = size_t(range / options_.bin_m);
    while (score_.by_range.size() <= bin) {
      score_.by_range.push_back({double(score_.by_range.size()) * options_.bin_m});
    }
    ++score_.objects;
    ++score_.by_range[bin].objects;
    FollowedObject& followed = followed_[r.id];
    followed.id = r.id;
    followed.label = r.label;
    followed.moments.push_back({reference.time_s, range, r, {}});
    if (!found) return;
    followed.moments.back().found = *found;
    ++score_.found;
    ++score_.by_range[bin].found;
    const double d = distance(r, *found);
    sum_ += d;
    squares_ += d * d;
    const double turn = std::abs(wrapped(2 * (r.box.yaw_rad - found->box.yaw_rad))) / 2;
    yaw_ += turn;
    uint64_t& last = last_id_[r.id];
    if (last && last != found->id) ++score_.switches;
    last = found->id;
  }

  double ospa(const ObjectList& reference, const ObjectList& list,
              const std::vector<uint8_t>& taken) {
    const double c = options_.ospa_cutoff_m, p = options_.ospa_order, whole = std::pow(c, p);
    std::vector<const TrackedObject*> others;
    for (size_t k = 0; k < list.objects.size(); ++k) {
      if (taken[k] || !options_.ignore_unmatched) others.push_back(&list.objects[k]);
    }
    const size_t rows = reference.objects.size(), columns = others.size();
    const size_t most = std::max(rows, columns);
    if (most == 0) return 0;
    cost_.clear();
    for (const TrackedObject& r : reference.objects) {
      for (const TrackedObject* o : others) {
        cost_.push_back(std::pow(std::min(distance(r, *o), c), p));
      }
    }
    const auto partner = assignment_.solve(cost_, rows, columns, whole);
    double sum = 0;
    size_t pairs = 0;
    for (size_t r = 0; r < rows; ++r) {
      if (partner[r] == kUnassigned) continue;
      sum += cost_[r * columns + partner[r]];
      ++pairs;
    }
    return std::pow((sum + whole * double(most - pairs)) / double(most), 1 / p);
  }

  const ListScoreOptions& options_;
  ListScore& score_;
  HotaCounts hota_;
  Assignment assignment_;
  std::vector<double> cost_;
  std::map<uint64_t, FollowedObject> followed_;
  std::map<uint64_t, uint64_t> last_id_;
  double sum_ = 0, squares_ = 0, yaw_ = 0, ospa_ = 0;
};

using Values = std::array<double, 6>;

// The values of an object over the truth's cycles.
using Series = std::map<double, Values>;

Values values_of(const OrientedBox& box, const Pose& from_world) {
  const Vec3 p = from_world * box.centre_m;
  return {p.x(), p.y(), p.z(), box.size_m.x(), box.size_m.y(), box.size_m.z()};
}

ValueErrors errors(const Series& a, const Series& b, const Values& first) {
  ValueErrors e;
  Values sum{};
  for (const auto& [time, v] : a) {
    const auto other = b.find(time);
    if (other == b.end()) continue;
    ++e.cycles;
    for (size_t k = 0; k < v.size(); ++k) sum[k] += std::pow(v[k] - other->second[k], 2);
  }
  for (size_t k = 0; k < sum.size(); ++k) {
    e.rmse_m[k] = std::sqrt(sum[k] / double(e.cycles));
    e.normalised[k] = e.rmse_m[k] / std::abs(first[k]);
  }
  return e;
}

/// An object in the truth and in a list that was compared with it.
struct Pair {
  Series truth, list;
};

std::map<uint64_t, Pair> series_of(const ListScore& score, const Pose& from_world) {
  std::map<uint64_t, Pair> out;
  for (const FollowedObject& object : score.followed) {
    Pair& pair = out[object.id];
    for (const Moment& m : object.moments) {
      pair.truth[m.time_s] = values_of(m.reference.box, from_world);
      if (m.found) pair.list[m.time_s] = values_of(m.found->box, from_world);
    }
  }
  return out;
}

}  // namespace

ListScore score_lists(std::span<const ObjectList> lists, std::span<const ObjectList> reference,
                      const ListScoreOptions& options) {
  require(options.gate_m > 0 && options.bin_m > 0 && options.ospa_cutoff_m > 0 &&
              options.ospa_order >= 1 && options.tolerance_s >= 0 && options.hota_zero_m > 0,
          "score of lists: an option is out of range");
  ListScore score;
  Comparison comparison(options, score);
  for (const ObjectList& r : reference) {
    const ObjectList* list = nearest(lists, r.time_s, options.tolerance_s);
    if (list) comparison.add(r, *list);
  }
  comparison.finish();
  return score;
}

std::vector<ComparedObject> compare_lists(std::span<const ObjectList> simulated,
                                          std::span<const ObjectList> real,
                                          std::span<const ObjectList> truth,
                                          const ListScoreOptions& options) {
  std::vector<ComparedObject> out;
  if (truth.empty()) return out;
  const Pose from_world = truth.front().world_from_vehicle.inverse();
  const ListScore sim_score = score_lists(simulated, truth, options);
  const auto sim = series_of(sim_score, from_world);
  const auto measured = series_of(score_lists(real, truth, options), from_world);
  for (const FollowedObject& object : sim_score.followed) {
    const Pair& s = sim.at(object.id);
    const auto r = measured.find(object.id);
    if (r == measured.end() || (s.list.empty() && r->second.list.empty())) continue;
    const Values& first = s.truth.begin()->second;
    out.push_back({object.id, object.label, errors(s.list, r->second.list, first),
                   errors(s.list, s.truth, first), errors(r->second.list, s.truth, first)});
  }
  return out;
}

}  // namespace underbrush::perception
