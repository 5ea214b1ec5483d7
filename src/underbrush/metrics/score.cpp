#include "underbrush/metrics/score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "underbrush/calibrate/ring_roughness.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/elements/label_sets.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/metrics/nearest.hpp"
#include "underbrush/metrics/predictive.hpp"
#include "underbrush/metrics/score_sums.hpp"

namespace underbrush::metrics {
namespace {

/// Reads the class of each beam as a number; empty where the log has no such column.
std::vector<uint32_t> classes_of(const BeamLog& log) {
  std::vector<uint32_t> out;
  const auto it = log.extra.find("class");
  if (it == log.extra.end()) return out;
  std::visit([&](const auto& c) { out.assign(c.begin(), c.end()); }, it->second);
  return out;
}

/// The beams [begin, end) of a log.
BeamLog rows_of(const BeamLog& log, size_t begin, size_t end) {
  BeamLog out = log.like();
  out.append(log, begin, end);
  return out;
}

class Scorer {
 public:
  Scorer(const ScoreOptions& options, std::string classes, bool keyframes)
      : options_(options),
        classes_(std::move(classes)),
        keyframes_(keyframes),
        world_(options.world),
        intensities_(options.range_edges_m, options.model) {
    sets_.resize(1 + options.range_edges_m.size() + 1);  // all, ranges, misses
    if (!options.world || !options.world->unknown_space()) return;
    first_support_ = sets_.size();
    sets_.resize(sets_.size() + kSupports.size());
  }

  /// Adds beams, the first of which has the number `first` in its log.
  void add(const BeamLog& real, const BeamLog& sim, size_t first) {
    if (!options_.open) return add_here(real, sim, first);
    const elements::Model& model = options_.world->model();
    const double range_m =
        std::min(real.info.max_range_m, std::max(model.reach_of(real.info), model.max_range_m));
    for (size_t begin = 0, end = 0; begin < real.size(); begin = end) {
      const OpenPart part = options_.open(real, begin, range_m);
      end = part.end;
      world_ = part.world;
      if (options_.model) intensities_.use(*part.world);
      add_here(rows_of(real, begin, end), rows_of(sim, begin, end), first + begin);
    }
  }

  Score finish() {
    if (options_.cloud) compare_clouds();
    Score score;
    score.cloud = options_.cloud;
    score.likelihood = options_.world != nullptr;
    score.range_error = histogram_;
    score.reliability = reliability_;
    score.roughness_m = roughness_[1].median();
    score.real_roughness_m = roughness_[0].median();
    score.all = sets_[0].finish();
    score.mover_beams = mover_beams_;
    score.intensity = intensities_.finish(score.no_intensity);
    const auto& edges = options_.range_edges_m;
    for (size_t k = 0; k < edges.size(); ++k) {
      if (sets_[1 + k].counts.beams) {
        score.per_range[bin_name(edges, k)] = sets_[1 + k].finish();
      }
    }
    if (sets_[1 + edges.size()].counts.beams) {
      score.per_range["miss"] = sets_[1 + edges.size()].finish();
    }
    for (size_t k = 0; first_support_ != kNoSet && k < kSupports.size(); ++k) {
      Sums& set = sets_[first_support_ + k];
      if (set.counts.beams) score.per_support[kSupports[k]] = set.finish();
    }
    for (const auto& [label, set] : class_set_) {
      score.per_class[elements::label_name(classes_, label)] = sets_[set].finish();
    }
    return score;
  }

 private:
  void add_here(const BeamLog& real, const BeamLog& sim, size_t first) {
    const std::vector<uint32_t> label = classes_of(real);
    predict_all(real);
    roughness_[0].add(real);
    roughness_[1].add(sim);
    intensities_.add(real, sim);
    for (size_t i = 0; i < real.size(); ++i) {
      if (real.scan[i] != sim.scan[i] || real.ring[i] != sim.ring[i] ||
          (real.origin[i] - sim.origin[i]).squaredNorm() > 1e-4) {
        throw DataError("score: the logs are not of the same beams (beam " +
                        std::to_string(first + i) +
                        "); score --protocol clouds compares logs that share no beams");
      }
      if (real.flags[i] & kMover) {
        ++mover_beams_;
        continue;
      }
      if (options_.world) reliability_.add(return_probability_[i], real.is_hit(i));
      const size_t of_class = label.empty() ? kNoSet : set_of_class(label[i]);
      const size_t set[4] = {0, set_of_range(real.range_m[i]), of_class, set_of_support(i)};
      for (size_t s : set) {
        if (s != kNoSet) add_beam(sets_[s], real, sim, i);
      }
      keep_points(real, sim, i, set);
    }
  }

  static constexpr size_t kNoSet = ~size_t(0);
  static constexpr double kMostError = 2;  // m
  static constexpr std::array<const char*, 3> kSupports{"unknown", "partly", "observed"};

  size_t set_of_support(size_t i) const {
    if (first_support_ == kNoSet) return kNoSet;
    return first_support_ + size_t(support_[i] >= 0.5) + size_t(support_[i] >= 0.9);
  }

  size_t set_of_range(float range) const {
    const auto& edges = options_.range_edges_m;
    if (range == kMiss) return 1 + edges.size();
    const auto above = std::upper_bound(edges.begin(), edges.end(), double(range));
    return above == edges.begin() ? kNoSet : size_t(above - edges.begin());
  }

  size_t set_of_class(uint32_t label) {
    const auto [it, added] = class_set_.try_emplace(label, sets_.size());
    if (added) sets_.emplace_back();
    return it->second;
  }

  void add_beam(Sums& s, const BeamLog& real, const BeamLog& sim, size_t i) {
    const bool hit = real.is_hit(i), sim_hit = sim.is_hit(i);
    ++s.counts.beams;
    ++(hit ? (sim_hit ? s.counts.true_hits : s.counts.false_misses)
           : (sim_hit ? s.counts.false_hits : s.counts.true_misses));
    if (hit && sim_hit) {
      const double error = (real.end_point(i) - sim.end_point(i)).norm();
      s.packets.add(uint64_t(real.scan[i]) << 32 | real.packet[i], error);
      s.capped += std::min(error, kMostError);
      const double range_error = double(sim.range_m[i]) - double(real.range_m[i]);
      s.range_errors.push_back(float(std::abs(range_error)));
      if (&s == &sets_[0]) histogram_.add(range_error);
    }
    if (hit != sim_hit) s.capped += kMostError;
    if (options_.world) {
      s.nll += nll_[i];
      s.crps += crps_[i];
      ++s.likelihoods;
    }
  }

  void predict_all(const BeamLog& real) {
    if (!world_) return;
    nll_.resize(real.size());
    crps_.resize(real.size());
    return_probability_.resize(real.size());
    support_.resize(real.size());
    const double max_range = real.info.max_range_m;
    const double reach = std::min(max_range, world_->model().reach_of(real.info));
    std::optional<keyframes::KeyframeCache> cache;
    if (keyframes_) cache.emplace(world_->model());
    parallel_for(real.size(), 2048, [&](size_t begin, size_t end) {
      std::vector<Ray> rays;
      for (size_t i = begin; i < end; ++i) {
        rays.push_back(real.ray(i));
      }
      trace::IntersectionLists met;
      const std::vector<double> everywhere(rays.size(), reach);
      const trace::RangeLimits limits{real.info.min_range_m, reach};
      world_->all_intersections(rays, limits, everywhere, met);
      std::vector<trace::Intersection> merged;
      trace::RangeMixture p;
      std::vector<keyframes::CachedPixels> pixels;
      if (cache) pixels = cache->look_up(cache->queries(rays, {&real.ring[begin], end - begin}));
      for (size_t i = begin; i < end; ++i) {
        const size_t k = i - begin;
        const auto all = world_->with_unknown(rays[k], limits, met[k], merged);
        trace::mix_ranges(all, 1, 1e-4, p);
        support_[i] = trace::support_of(all, p);
        if (cache) cache->mix(pixels[i - begin], p);
        return_probability_[i] = return_probability(p);
        nll_[i] = negative_log_likelihood(p, real.range_m[i], max_range);
        crps_[i] = crps(p, real.range_m[i], max_range);
      }
    });
  }

  void keep_points(const BeamLog& real, const BeamLog& sim, size_t i, const size_t (&set)[4]) {
    if (!options_.cloud) return;
    if (!have_origin_) origin_ = real.origin[i], have_origin_ = true;
    const BeamLog* logs[2] = {&real, &sim};
    for (int side = 0; side < 2; ++side) {
      if (!logs[side]->is_hit(i)) continue;
      points_[side].push_back((logs[side]->end_point(i) - origin_).cast<float>());
      point_sets_[side].push_back({uint32_t(set[1]), uint32_t(set[2]), uint32_t(set[3])});
    }
  }

  void compare_clouds() {
    if (points_[0].empty() || points_[1].empty()) return;
    for (int side = 0; side < 2; ++side) {
      const Nearest n = nearest(points_[side], points_[1 - side]);
      const std::vector<double> chamfer = chamfer_terms(n, points_[1 - side].size());
      for (size_t i = 0; i < n.index.size(); ++i) {
        const double d = n.distance_m[i], c = chamfer[i];
        for (size_t s : {size_t(0), size_t(point_sets_[side][i][0]),
                         size_t(point_sets_[side][i][1]), size_t(point_sets_[side][i][2])}) {
          if (s >= sets_.size()) continue;
          sets_[s].cloud[side] += d;
          sets_[s].chamfer[side] += c;
          ++sets_[s].points[side];
        }
      }
    }
  }

  const ScoreOptions& options_;
  std::string classes_;        // the label set
  bool keyframes_;             // whether those of the world's model answer beams of the real log
  const trace::World* world_;  // the part of it that is open
  std::vector<Sums> sets_;
  std::map<uint32_t, size_t> class_set_;
  RangeErrorHistogram histogram_;
  IntensityScorer intensities_;
  calibrate::RingRoughness roughness_[2];  // of the real log, and of the simulated one
  std::vector<double> nll_, crps_, return_probability_, support_;
  size_t first_support_ = kNoSet;  // the first of `sets_` by support
  Reliability reliability_;
  size_t mover_beams_ = 0;
  bool have_origin_ = false;
  Vec3 origin_ = Vec3::Zero();
  std::vector<Vec3f> points_[2];
  std::vector<std::array<uint32_t, 3>> point_sets_[2];
};

}  // namespace

void RangeErrorHistogram::add(double error_m) {
  const double at = (error_m + kHalfWidth) / kBin;
  const double last = double(count.size()) - 2;
  ++count[at < 0 ? 0 : at >= last ? count.size() - 1 : size_t(at) + 1];
}

Score score(BeamSource& real, BeamSource& simulated, const ScoreOptions& options,
            const std::function<void(size_t, size_t)>& progress) {
  if (real.size() != simulated.size()) {
    throw DataError("score: " + std::to_string(real.size()) + " real beams but " +
                    std::to_string(simulated.size()) +
                    " simulated ones; score --protocol clouds compares logs that share no "
                    "beams");
  }
  const bool keyframes = options.world && options.world->is_one_model() &&
                         keyframes::KeyframeCache::serves(options.world->model(), real);
  Scorer scorer(options, real.info().classes, keyframes);
  // The world has true ranges, and both logs have the offsets of the sensor's channels.
  const ChannelOffsets channels =
      options.world ? options.world->model().channels_of(real.info()) : ChannelOffsets();
  CorrectedBeams true_real(real, channels), true_simulated(simulated, channels);
  BeamLog a, b, rest;
  size_t done = 0;
  true_real.rewind();
  true_simulated.rewind();
  while (true_real.next(a)) {
    BeamLog sim = std::move(rest);
    rest = BeamLog();
    while (sim.size() < a.size() && true_simulated.next(b)) {
      if (sim.empty()) {
        sim = std::move(b);
      } else {
        sim.append(b, 0, b.size());
      }
    }
    if (sim.size() > a.size()) {
      rest = rows_of(sim, a.size(), sim.size());
      sim.resize(a.size());
    }
    require_data(sim.size() == a.size(), "score: the simulated log ends early");
    scorer.add(a, sim, done);
    done += a.size();
    if (progress) progress(done, real.size());
  }
  return scorer.finish();
}

}  // namespace underbrush::metrics
