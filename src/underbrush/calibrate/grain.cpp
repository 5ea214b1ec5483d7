#include "underbrush/calibrate/grain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "underbrush/calibrate/ring_roughness.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/core/still_beams.hpp"
#include "underbrush/simulate/simulate.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::calibrate {
namespace {

constexpr size_t kBeams = 30000, kLeastDifferences = 500;
constexpr double kFinest = 0.005, kCoarsest = 0.5;  // m
constexpr int kGrainRounds = 6;
constexpr double kSettledChange = 0.02;  // of a side or the noise, relative
/// Three beams count as of a group only if all of them end there. The ellipsoids of the classes
/// that have a grain of their own follow as groups `kOther` + `elements::Grain::place_of`.
enum BeamGroup : uint8_t { kMesh, kOther };

uint8_t group_of(size_t place) { return uint8_t(kOther + place); }

/// Keeps whole scans, chosen by their number, or the beginning of a log of few scans.
BeamLog sample_of(BeamSource& log, uint64_t seed) {
  log.rewind();
  const double share = double(kBeams) / double(std::max<size_t>(1, log.size()));
  // Scans are taken from the first quarter of a long log, which is quick to read.
  const double rate = double(log.info().scans.size()) * share < 4 ? 1 : std::min(1.0, 4 * share);
  BeamLog sample, chunk;
  bool first = true;
  while (sample.size() < kBeams && log.next(chunk)) {
    if (first) sample = chunk.like();
    first = false;
    for (size_t i = 0; i < chunk.size() && sample.size() < 2 * kBeams; ++i) {
      const uint64_t bits = random_bits(seed, chunk.scan[i], Purpose::kCluster);
      if (uniform_from_bits(bits) < rate) sample.append(chunk, i);
    }
  }
  return sample;
}

/// Answers the beams, and gives the group of each.
BeamLog answered(const trace::World& world, uint64_t seed, BeamLog beams,
                 std::vector<uint8_t>* groups = nullptr) {
  simulate::Options options;
  options.seed = seed;
  options.element_ids = groups != nullptr;
  simulate::simulate(world, options, 0, beams);
  if (!groups) return beams;
  const auto& element = std::get<std::vector<uint32_t>>(beams.extra.at("element"));
  const elements::Model& model = world.model();
  groups->assign(beams.size(), kOther);
  for (size_t i = 0; i < beams.size(); ++i) {
    if (!beams.is_hit(i)) continue;
    const elements::ElementPlace place = model.place(element[i]);
    (*groups)[i] = place.kind != elements::Kind::kEllipsoid
                       ? uint8_t(kMesh)
                       : group_of(model.grain.place_of(model.ellipsoids[place.index].label));
  }
  return beams;
}

RingRoughness roughness_of(const BeamLog& beams, std::span<const uint8_t> groups) {
  RingRoughness r;
  r.add(beams, groups);
  return r;
}

double median_of_all(const BeamLog& beams) { return roughness_of(beams, {}).median(); }

/// Makes a grain coarser where the simulated log is rougher than the real one. The logarithm of the
/// roughness falls by a third to two thirds of that of the grain, so the step converges. Returns
/// whether the grain changed.
bool adjust(double& side_m, uint8_t group, const RingRoughness& real,
            const RingRoughness& simulated) {
  if (real.count(group) < kLeastDifferences) return false;
  const double ratio = simulated.geometric_mean(group) / real.geometric_mean(group);
  if (!std::isfinite(ratio)) return false;
  const double before = side_m;
  side_m = std::clamp(side_m * ratio * ratio, kFinest, kCoarsest);
  return std::abs(side_m - before) > kSettledChange * before;
}

/// Adjusts the noise to the smoothest quarter of the log, in which hardly anything else is left.
/// Returns whether the noise changed.
bool adjust_noise(double& noise_m, double most_m, const RingRoughness& real,
                  const RingRoughness& simulated) {
  const BeamGroup group = real.count(kMesh) >= kLeastDifferences ? kMesh : kOther;
  const double ratio = real.quantile(0.25, group) / simulated.quantile(0.25, group);
  if (!std::isfinite(ratio)) return false;
  const double before = noise_m;
  noise_m = std::min(most_m, noise_m * ratio);
  return std::abs(noise_m - before) > kSettledChange * before;
}

/// `learn_grain` for a model of elements alone.
GrainReport grain_of_elements(elements::Model& model, BeamSource& log, uint64_t seed) {
  GrainReport report;
  report.classes.assign(model.grain.classes.size(), false);
  StillBeams still(log);
  const BeamLog beams = sample_of(still, seed);
  if (beams.empty() || model.size() == 0) return report;
  std::vector<uint8_t> groups;
  const BeamLog anew = answered(trace::World(model), seed, beams, &groups);
  const RingRoughness real = roughness_of(beams, groups);
  report.meshes = real.count(kMesh) >= kLeastDifferences;
  report.ellipsoids = real.count(kOther) >= kLeastDifferences;
  for (size_t k = 0; k < model.grain.classes.size(); ++k) {
    report.classes[k] = real.count(group_of(k + 1)) >= kLeastDifferences;
  }
  if (!report.learnt()) return report;
  report.real_m = median_of_all(beams);
  report.anew_m = median_of_all(anew);
  const double most_noise_m = model.range_noise_m;
  trace::World world(model, trace::Isa::kBest, trace::Draws::kOnce);
  bool settled = false;
  for (int k = 0;; ++k) {
    world.update_grain();
    const BeamLog once = answered(world, seed, beams);
    if (settled || k == kGrainRounds) {
      report.simulated_m = median_of_all(once);
      return report;
    }
    const RingRoughness simulated = roughness_of(once, groups);
    elements::Grain& grain = model.grain;
    bool changed = adjust(grain.ellipsoid_m, kOther, real, simulated);
    changed |= adjust(grain.mesh_m, kMesh, real, simulated);
    for (size_t p = 1; p <= grain.classes.size(); ++p) {
      changed |= adjust(grain.classes[p - 1].side_m, group_of(p), real, simulated);
    }
    changed |= adjust_noise(model.range_noise_m, most_noise_m, real, simulated);
    settled = !changed;
  }
}

}  // namespace

GrainReport learn_grain(elements::Model& model, BeamSource& log, uint64_t seed) {
  const auto keyframes = std::exchange(model.keyframes, nullptr);
  const auto observed = std::exchange(model.observed, nullptr);
  elements::Light light = std::exchange(model.light, {});  // The intensities do not count.
  GrainReport report = grain_of_elements(model, log, seed);
  model.keyframes = keyframes;
  model.observed = observed;
  model.light = std::move(light);
  return report;
}

}  // namespace underbrush::calibrate
