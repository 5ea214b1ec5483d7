#include "underbrush/calibrate/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "underbrush/core/rng.hpp"

namespace underbrush::calibrate {
namespace {

constexpr double kSamePlaceM = 0.05, kSameDirection = 0.05 * M_PI / 180;
constexpr double kPatch = 0.25 * M_PI / 180;  // patches of directions that are kept or left out
constexpr size_t kSampled = 60000;
constexpr size_t kMostInCell = 32;  // beams of one scan and nearly one direction
constexpr size_t kRun = 4;

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

}  // namespace

Repeats repeats_of(BeamSource& log, uint64_t seed) {
  const std::vector<ScanInfo> scans = scans_of(log);
  const std::vector<Run> runs = runs_of(scans, log.size());
  if (runs.empty()) return {};
  Repeats out{true, sample_of(log, runs, scans.size(), seed), {}};
  out.pairs = repeats_in(out.beams, runs);
  return out;
}

std::optional<double> range_noise_of(const Repeats& repeats) {
  if (repeats.pairs.size() < kLeastPairs) return {};
  constexpr double kQuarter = 0.31864;  // the lower quartile of |x| of a standard normal x
  std::vector<double> differences;
  differences.reserve(repeats.pairs.size());
  for (const auto& [i, j] : repeats.pairs) {
    differences.push_back(
        std::abs(double(repeats.beams.range_m[i]) - double(repeats.beams.range_m[j])));
  }
  const auto quarter = differences.begin() + std::ptrdiff_t(differences.size() / 4);
  std::nth_element(differences.begin(), quarter, differences.end());
  return std::max(*quarter / (M_SQRT2 * kQuarter), kLeastNoiseM);
}

}  // namespace underbrush::calibrate
