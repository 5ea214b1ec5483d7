#include "underbrush/fit/expectation.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::fit {
namespace {

/// Elements beyond a return count if their closest approach lies up to this much farther, because
/// their Gaussians reach back to the return, m.
constexpr double kBeyondM = 4;

/// Keeps the elements met up to `reach_m`. The tracer may list more, and how many depends on how
/// rays were batched.
std::span<const trace::Intersection> up_to(std::span<const trace::Intersection> met,
                                           double reach_m) {
  size_t n = met.size();
  while (n > 0 && met[n - 1].t_m > reach_m) --n;
  return met.first(n);
}

/// Totals over the beams. A −log f is below 20, so its fixed-point sum does not overflow.
struct Totals {
  FixedSum training, held_out, stray_hits;
  FixedSum training_beams, held_out_beams;
};

void add_beams(const trace::World& world, const BeamLog& chunk, size_t begin, size_t end,
               const HeldOut& held_out, const trace::OutlierShares& soft, Totals& totals,
               ElementSums& sums) {
  const double max_range = chunk.info.max_range_m;
  const trace::RangeLimits limits{chunk.info.min_range_m,
                                  std::min(max_range, world.model().max_range_m)};
  std::vector<Ray> rays;
  std::vector<double> reach;
  for (size_t i = begin; i < end; ++i) {
    rays.push_back(chunk.ray(i));
    reach.push_back(std::min(double(chunk.range_m[i]) + kBeyondM, limits.max_m));
  }
  trace::IntersectionLists met;
  world.all_intersections(rays, limits, reach, met);
  Responsibilities shares;
  for (size_t i = begin; i < end; ++i) {
    const double range = chunk.range_m[i];
    const std::span<const trace::Intersection> list = up_to(met[i - begin], reach[i - begin]);
    const bool kept_back = held_out(chunk, i);
    find_responsibilities(list, range, trace::kReportedOutliers, max_range, shares);
    (kept_back ? totals.held_out : totals.training).add(-shares.log_likelihood);
    (kept_back ? totals.held_out_beams : totals.training_beams).add(1);
    if (kept_back) continue;
    find_responsibilities(list, range, soft, max_range, shares);
    if (range != kMiss) totals.stray_hits.add(shares.unexplained);
    sums.add(rays[i - begin], list, range, shares);
  }
}

}  // namespace

bool HeldOut::operator()(const BeamLog& log, size_t i) const {
  if (one_in == 0) return false;
  const Vec3f& d = log.direction[i];
  const float turn = d.y() / std::max(std::abs(d.x()) + std::abs(d.y()), 1e-9f);
  const uint32_t cell = uint32_t(int(std::floor(256 * turn)) + 256) * 2 + (d.x() > 0);
  const uint64_t group = uint64_t(log.packet[i]) << 32 | cell;
  return random_bits(beam_key(seed, log.scan[i], group), 0, Purpose::kSplit) % one_in == 0;
}

TrainingSource::TrainingSource(BeamSource& source, const HeldOut& held_out)
    : source_(source), held_out_(held_out) {
  source_.rewind();
  BeamLog chunk;
  while (source_.next(chunk)) {
    for (size_t i = 0; i < chunk.size(); ++i) size_ += !held_out_(chunk, i);
  }
  source_.rewind();
}

bool TrainingSource::next(BeamLog& chunk) {
  BeamLog all;
  while (source_.next(all)) {
    chunk = all.like();
    for (size_t i = 0, from = 0; i <= all.size(); ++i) {
      if (i < all.size() && !held_out_(all, i)) continue;
      if (from < i) chunk.append(all, from, i);
      from = i + 1;
    }
    if (!chunk.empty()) return true;
  }
  chunk = all;
  return false;
}

Expectation expect(const elements::Model& model, BeamSource& source, const HeldOut& held_out,
                   const trace::OutlierShares& soft,
                   const std::function<void(size_t, size_t)>& progress) {
  const trace::World world(model);
  Expectation out;
  out.sums = ElementSums(model);
  Totals totals;
  source.rewind();
  BeamLog chunk;
  size_t done = 0;
  while (source.next(chunk)) {
    parallel_for(chunk.size(), 4096, [&](size_t begin, size_t end) {
      add_beams(world, chunk, begin, end, held_out, soft, totals, out.sums);
    });
    done += chunk.size();
    if (progress) progress(done, source.size());
  }
  out.training_beams = size_t(totals.training_beams.value());
  out.held_out_beams = size_t(totals.held_out_beams.value());
  const double trained = std::max(1.0, totals.training_beams.value());
  out.training_nll = totals.training.value() / trained;
  out.held_out_nll = totals.held_out.value() / std::max(1.0, totals.held_out_beams.value());
  out.stray_hits = totals.stray_hits.value() / trained;
  return out;
}

}  // namespace underbrush::fit
