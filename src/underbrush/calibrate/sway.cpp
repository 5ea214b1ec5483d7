#include "underbrush/calibrate/sway.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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
constexpr double kSector = 2 * M_PI / 180;  // sectors of bearing that are kept or left out
constexpr size_t kBeams = 60000, kLeastPairs = 500;
constexpr size_t kRun = 4;
constexpr int kRounds = 4;
constexpr double kLeastExcess = 1.25;  // of the difference of still matter

bool stands(const ScanInfo& a, const ScanInfo& b) {
  const Pose &p = a.world_from_sensor, &q = b.world_from_sensor;
  return (p.translation - q.translation).norm() <= kSamePlaceM &&
         p.rotation.angularDistance(q.rotation) <= kSameDirection;
}

/// A run of scans from one place, by their numbers in `LogInfo::scans`: `begin` to `end` - 1.
struct Run {
  size_t begin, end;
};

/// Runs of up to `kRun` scans, of which a log that is a half of another has the half: as many as
/// have about `kBeams` beams, spread over the log.
std::vector<Run> runs_of(const LogInfo& info, size_t beams) {
  std::vector<Run> all;
  for (size_t s = 0; s < info.scans.size();) {
    Run run{s, s + 1};
    while (run.end < std::min(s + kRun, info.scans.size()) &&
           stands(info.scans[s], info.scans[run.end])) {
      ++run.end;
    }
    s = run.end;
    if (run.end > run.begin + 1) all.push_back(run);
  }
  if (all.empty()) return all;
  const size_t each = kRun * std::max<size_t>(1, beams / info.scans.size());
  const size_t count = std::clamp<size_t>(kBeams / each, 1, all.size());
  std::vector<Run> some;
  for (size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return some;
}

double bearing_of(const Vec3f& d) { return std::atan2(double(d.y()), double(d.x())); }

/// The returns in the scans of runs, or those in some sectors of bearing where all would be too
/// many.
BeamLog sample_of(BeamSource& log, const std::vector<Run>& runs, uint64_t seed) {
  const std::vector<ScanInfo>& scans = log.info().scans;
  std::unordered_set<uint32_t> wanted;
  for (const Run& run : runs) {
    for (size_t s = run.begin; s < run.end; ++s) wanted.insert(scans[s].scan);
  }
  const double expected = double(wanted.size()) * double(log.size()) / double(scans.size());
  const double share = double(kBeams) / std::max(double(kBeams), expected);
  BeamLog sample, chunk;
  bool first = true;
  log.rewind();
  while (log.next(chunk)) {
    if (std::exchange(first, false)) sample = chunk.like();
    if (chunk.scan.front() > scans[runs.back().end - 1].scan) break;
    for (size_t i = 0; i < chunk.size(); ++i) {
      if (!chunk.is_hit(i) || !wanted.contains(chunk.scan[i])) continue;
      const auto sector = uint32_t(std::floor((bearing_of(chunk.direction[i]) + M_PI) / kSector));
      const uint64_t bits = random_bits(seed, sector, Purpose::kCluster);
      if (uniform_from_bits(bits) < share) sample.append(chunk, i);
    }
  }
  return sample;
}

/// Finds the beam of one scan that has the direction of a beam of the next one.
class Directions {
 public:
  explicit Directions(const BeamLog& beams) : beams_(beams) {}

  void add(size_t i) { at_.emplace(cell_of(i, 0, 0), i); }
  /// The nearest direction of the same ring, from the same place; the beam's number.
  std::optional<size_t> of(size_t i) const {
    std::optional<size_t> best;
    double least = kSameDirection;
    for (int bearing = -1; bearing <= 1; ++bearing) {
      for (int height = -1; height <= 1; ++height) {
        const auto [from, to] = at_.equal_range(cell_of(i, bearing, height));
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
  uint64_t cell_of(size_t i, int bearing, int height) const {
    constexpr double kCell = 2 * kSameDirection;
    const Vec3f& d = beams_.direction[i];
    const auto number = [&](double x) { return int64_t(std::floor(x / kCell)); };
    return uint64_t(number(bearing_of(d)) + bearing) << 32 ^
           uint32_t(number(std::asin(std::clamp(double(d.z()), -1.0, 1.0))) + height);
  }

  const BeamLog& beams_;
  std::unordered_multimap<uint64_t, size_t> at_;
};

using BeamPairs = std::vector<std::pair<size_t, size_t>>;

/// The beams of the sample that repeat one of the scan before.
BeamPairs repeats_in(const BeamLog& beams, const std::vector<ScanInfo>& scans,
                     const std::vector<Run>& runs) {
  std::unordered_map<uint32_t, std::vector<size_t>> rows;
  for (size_t i = 0; i < beams.size(); ++i) rows[beams.scan[i]].push_back(i);
  BeamPairs out;
  for (const Run& run : runs) {
    std::optional<Directions> before;
    for (size_t s = run.begin; s < run.end; ++s) {
      const std::vector<size_t>& now = rows[scans[s].scan];
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

/// The geometric mean of |Δ range| + 1 mm of the pairs that both return, m.
double difference(const BeamLog& beams, const BeamPairs& pairs) {
  double sum = 0;
  size_t count = 0;
  for (const auto& [i, j] : pairs) {
    if (!beams.is_hit(i) || !beams.is_hit(j)) continue;
    sum += std::log(std::abs(double(beams.range_m[i]) - double(beams.range_m[j])) + 1e-3);
    ++count;
  }
  return std::exp(sum / double(count));
}

}  // namespace

SwayReport learn_sway(elements::Model& model, BeamSource& log, uint64_t seed) {
  SwayReport report;
  model.sway_s = 0;
  const std::vector<ScanInfo>& scans = log.info().scans;
  const std::vector<Run> runs = runs_of(log.info(), log.size());
  if (runs.empty() || model.ellipsoids.empty()) return report;
  StillBeams still_beams(log);
  const BeamLog beams = sample_of(still_beams, runs, seed);
  BeamPairs pairs = repeats_in(beams, scans, runs);
  keep_on_ellipsoids(model, seed, beams, pairs);
  if (pairs.size() < kLeastPairs) return report;
  std::vector<double> interval;
  for (const auto& [i, j] : pairs) interval.push_back(beams.time_s[j] - beams.time_s[i]);
  const auto middle = interval.begin() + std::ptrdiff_t(interval.size() / 2);
  std::nth_element(interval.begin(), middle, interval.end());
  simulate::Options options;
  options.seed = seed;
  report = {pairs.size(), *middle, difference(beams, pairs),
            difference(answered(model, trace::Draws::kOnce, options, beams), pairs),
            difference(answered(model, trace::Draws::kAnew, options, beams), pairs)};
  const double excess = report.real_m / report.still_m, most = report.anew_m / report.still_m;
  if (!(report.interval_s > 0 && excess > kLeastExcess && most > 1)) return report;
  // A beam passes several cells, so the outcomes change faster than the matter of one of them.
  const double goal = std::min(1.0, std::log(excess) / std::log(most));
  model.sway_s = report.interval_s / goal;
  for (int k = 0; k < kRounds; ++k) {
    options.sway_s = model.sway_s;
    report.swaying_m = difference(answered(model, trace::Draws::kSwaying, options, beams), pairs);
    const double share = std::log(report.swaying_m / report.still_m) / std::log(most);
    model.sway_s = std::max(report.interval_s, model.sway_s * share / goal);
  }
  report.learnt = true;
  return report;
}

}  // namespace underbrush::calibrate
