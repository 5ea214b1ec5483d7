#include "underbrush/calibrate/sway.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "underbrush/core/rng.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kSamePlaceM = 0.05, kSameDirection = 0.05 * M_PI / 180;
constexpr double kPatch = 0.25 * M_PI / 180;  // patches of directions that are kept or left out
constexpr size_t kSampled = 60000, kLeastPairs = 500;
constexpr size_t kMostInCell = 32;  // beams of one scan and nearly one direction
constexpr size_t kRun = 4;
constexpr int kRoundsOfTime = 4;
constexpr double kLeastExcess = 1.25;  // of the difference of still matter

/// The scans of a log; where it does not list them, by the rows, whose mean origin is the place.
std::vector<ScanInfo> scans_of(BeamSource& log) {
  if (!log.info().scans.empty()) return log.info().scans;
  std::map<uint32_t, std::pair<ScanInfo, size_t>> found;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) {
    for (size_t i = 0; i < chunk.size(); ++i) {
      auto& [scan, rows] = found[chunk.scan[i]];
      if (rows++ == 0) scan.time_s = chunk.time_s[i];
      scan.scan = chunk.scan[i];
      scan.world_from_sensor.translation += chunk.origin[i];
    }
  }
  std::vector<ScanInfo> out;
  for (auto& [number, of] : found) {
    of.first.world_from_sensor.translation /= double(of.second);
    out.push_back(of.first);
  }
  return out;
}

bool stands(const ScanInfo& a, const ScanInfo& b) {
  const Pose &p = a.world_from_sensor, &q = b.world_from_sensor;
  return (p.translation - q.translation).norm() <= kSamePlaceM &&
         p.rotation.angularDistance(q.rotation) <= kSameDirection;
}

/// Successive scans from one place.
using Run = std::span<const ScanInfo>;

/// Runs of up to `kRun` scans. A log of every second scan has pairs in each run, too. The runs are
/// spread over the log, and there are as many as have about `kSampled` beams, at least one.
std::vector<Run> runs_of(std::span<const ScanInfo> scans, size_t beams) {
  std::vector<Run> all;
  for (size_t s = 0; s < scans.size();) {
    size_t end = s + 1;
    while (end < std::min(s + kRun, scans.size()) && stands(scans[s], scans[end])) ++end;
    if (end > s + 1) all.push_back(scans.subspan(s, end - s));
    s = end;
  }
  if (all.empty()) return all;
  const size_t each = kRun * std::max<size_t>(1, beams / scans.size());
  const size_t count = std::clamp<size_t>(kSampled / each, 1, all.size());
  std::vector<Run> some;
  for (size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return some;
}

/// The number of the cell of directions of a size (rad) that is `east` and `up` cells beside the
/// one of a direction.
uint64_t cell_of(const Vec3f& d, double size, int east = 0, int up = 0) {
  const auto number = [&](double angle) { return int64_t(std::floor(angle / size)); };
  const double height = std::asin(std::clamp(double(d.z()), -1.0, 1.0));
  return uint64_t(number(std::atan2(double(d.y()), double(d.x()))) + east) << 32 ^
         uint32_t(number(height) + up);
}

/// The returns in the scans of runs, or those in some patches of directions, the same ones in each
/// scan, where all would be too many. `scans` is the number of all scans.
BeamLog sample_of(BeamSource& log, const std::vector<Run>& runs, size_t scans, uint64_t seed) {
  std::unordered_set<uint32_t> wanted;
  uint32_t last = 0;
  for (const Run& run : runs) {
    for (const ScanInfo& scan : run) wanted.insert(scan.scan);
    last = std::max(last, run.back().scan);
  }
  const double expected = double(wanted.size()) * double(log.size()) / double(scans);
  const double share = double(kSampled) / std::max(double(kSampled), expected);
  BeamLog sample, chunk;
  bool first = true;
  log.rewind();
  while (sample.size() < 2 * kSampled && log.next(chunk)) {
    if (std::exchange(first, false)) sample = chunk.like();
    if (*std::ranges::min_element(chunk.scan) > last) break;
    for (size_t i = 0; i < chunk.size() && sample.size() < 2 * kSampled; ++i) {
      if (!chunk.is_hit(i) || !wanted.contains(chunk.scan[i])) continue;
      const uint64_t patch = mix64(seed ^ mix64(cell_of(chunk.direction[i], kPatch)));
      if (uniform_from_bits(patch) < share) sample.append(chunk, i);
    }
  }
  return sample;
}

/// Finds the beam of one scan that has the direction of a beam of the next one.
class Directions {
 public:
  explicit Directions(const BeamLog& beams) : beams_(beams) {}

  void add(size_t i) {
    const uint64_t cell = cell_of(beams_.direction[i], kCell);
    if (at_.count(cell) < kMostInCell) at_.emplace(cell, i);
  }
  /// The nearest direction of the same ring, from the same place; the beam's number.
  std::optional<size_t> of(size_t i) const {
    std::optional<size_t> best;
    double least = kSameDirection;
    for (int east = -1; east <= 1; ++east) {
      for (int up = -1; up <= 1; ++up) {
        const auto [from, to] = at_.equal_range(cell_of(beams_.direction[i], kCell, east, up));
        for (auto k = from; k != to; ++k) {
          const size_t j = k->second;
          const double angle = double((beams_.direction[i] - beams_.direction[j]).norm());
          const bool here = (beams_.origin[i] - beams_.origin[j]).norm() <= kSamePlaceM;
          if (beams_.ring[i] != beams_.ring[j] || !here || angle > least) continue;
          least = angle;
          best = j;
        }
      }
    }
    return best;
  }

 private:
  static constexpr double kCell = 2 * kSameDirection;

  const BeamLog& beams_;
  std::unordered_multimap<uint64_t, size_t> at_;
};

using BeamPairs = std::vector<std::pair<size_t, size_t>>;

/// The beams of the sample that repeat one of the scan before.
BeamPairs repeats_in(const BeamLog& beams, const std::vector<Run>& runs) {
  std::unordered_map<uint32_t, std::vector<size_t>> rows;
  for (size_t i = 0; i < beams.size(); ++i) rows[beams.scan[i]].push_back(i);
  BeamPairs out;
  for (const Run& run : runs) {
    std::optional<Directions> before;
    for (const ScanInfo& scan : run) {
      const std::vector<size_t>& now = rows[scan.scan];
      if (now.empty()) continue;  // The log does not have this scan.
      for (const size_t i : now) {
        const std::optional<size_t> j = before ? before->of(i) : std::nullopt;
        if (j) out.emplace_back(*j, i);
      }
      before.emplace(beams);
      for (const size_t i : now) before->add(i);
    }
  }
  return out;
}

BeamLog answered(const elements::Model& model, trace::Draws draws, const simulate::Options& options,
                 BeamLog beams) {
  simulate::simulate(trace::World(model, trace::Isa::kBest, draws), options, 0, beams);
  return beams;
}

/// Leaves out pairs with a beam that does not end on an ellipsoid; keyframes have no part in that.
void keep_on_ellipsoids(const elements::Model& model, uint64_t seed, const BeamLog& beams,
                        BeamPairs& pairs) {
  simulate::Options options;
  options.seed = seed;
  options.element_ids = true;
  const BeamLog still = answered(model, trace::Draws::kOnce, options, beams);
  const auto& element = std::get<std::vector<uint32_t>>(still.extra.at("element"));
  const auto on_ellipsoid = [&](size_t i) {
    return element[i] < model.size() && model.kind(element[i]) == elements::Kind::kEllipsoid;
  };
  std::erase_if(pairs, [&](const std::pair<size_t, size_t>& pair) {
    return !on_ellipsoid(pair.first) || !on_ellipsoid(pair.second);
  });
}

/// The geometric mean of |Δ range| + 1 mm of the pairs that both return, m; 0 where none does.
double difference(const BeamLog& beams, const BeamPairs& pairs) {
  double sum = 0;
  size_t count = 0;
  for (const auto& [i, j] : pairs) {
    if (!beams.is_hit(i) || !beams.is_hit(j)) continue;
    sum += std::log(std::abs(double(beams.range_m[i]) - double(beams.range_m[j])) + 1e-3);
    ++count;
  }
  return count > 0 ? std::exp(sum / double(count)) : 0;
}

double median_interval(const BeamLog& beams, const BeamPairs& pairs) {
  std::vector<double> interval;
  interval.reserve(pairs.size());
  for (const auto& [i, j] : pairs) interval.push_back(beams.time_s[j] - beams.time_s[i]);
  const auto middle = interval.begin() + std::ptrdiff_t(interval.size() / 2);
  std::nth_element(interval.begin(), middle, interval.end());
  return *middle;
}

}  // namespace

SwayReport learn_sway(elements::Model& model, BeamSource& log, uint64_t seed) {
  SwayReport report;
  model.sway_s = 0;
  if (model.ellipsoids.empty()) return report;
  StillBeams still(log);
  const std::vector<ScanInfo> scans = scans_of(still);
  const std::vector<Run> runs = runs_of(scans, log.size());
  report.stands = !runs.empty();
  if (!report.stands) return report;
  const BeamLog beams = sample_of(still, runs, scans.size(), seed);
  BeamPairs pairs = repeats_in(beams, runs);
  keep_on_ellipsoids(model, seed, beams, pairs);
  report.pairs = pairs.size();
  if (pairs.size() < kLeastPairs) return report;
  simulate::Options options;
  options.seed = seed;
  const auto of = [&](trace::Draws draws) {
    return difference(answered(model, draws, options, beams), pairs);
  };
  report.interval_s = median_interval(beams, pairs);
  report.real_m = difference(beams, pairs);
  report.still_m = of(trace::Draws::kOnce);
  report.anew_m = of(trace::Draws::kAnew);
  const double excess = report.real_m / report.still_m, most = report.anew_m / report.still_m;
  report.known = report.interval_s > 0 && report.still_m > 0 && most > 1;
  if (!report.known || excess <= kLeastExcess) return report;
  // A beam passes several cells, so the outcomes change faster than the matter of one of them.
  const double goal = std::min(1.0, std::log(excess) / std::log(most));
  options.sway_s = report.interval_s / goal;
  for (int k = 0; k < kRoundsOfTime; ++k) {
    const double share = std::log(of(trace::Draws::kSwaying) / report.still_m) / std::log(most);
    options.sway_s = std::max(report.interval_s, options.sway_s * share / goal);
  }
  model.sway_s = options.sway_s;
  return report;
}

}  // namespace underbrush::calibrate
