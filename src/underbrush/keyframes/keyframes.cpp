#include "underbrush/keyframes/keyframes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/keyframes/changed_pixels.hpp"
#include "underbrush/keyframes/keyframe_cache.hpp"
#include "underbrush/keyframes/keyframe_images.hpp"
#include "underbrush/keyframes/keyframe_weights.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframes;

/// Beams are looked up in the keyframes that are at least so far away, m.
constexpr double kLeastDistances[] = {0, 0, 0.5, 1, 2, 4};

/// Beams of a log, looked up in its keyframes.
class Sampler {
 public:
  Sampler(const elements::Model& model, const std::map<uint32_t, uint32_t>& frame_of_scan,
          const LogInfo& log, size_t beams, const KeyframeOptions& options)
      : is_one_scan_(model.keyframes->frames.size() == 1),
        frame_of_scan_(frame_of_scan),
        world_(model),
        cache_(model),
        min_range_m_(options.min_range_m),
        max_range_m_(log.max_range_m),
        reach_m_(std::min(log.max_range_m, model.max_range_m)),
        limits_{log.min_range_m, reach_m_},
        held_out_(usable(options, beams)),
        one_in_(1 + beams / std::max(1u, held_out_.one_in) / std::max<size_t>(options.samples, 1)) {
  }

  void add(const BeamLog& chunk, std::vector<WeightSample>& samples) {
    std::vector<Row> rows;
    for (size_t i = 0; i < chunk.size(); ++i) {
      const uint64_t bits = mix64(++row_);
      if (bits % one_in_ != 0 || (held_out_.one_in > 0 && !held_out_(chunk, i))) continue;
      if (chunk.is_hit(i) && double(chunk.range_m[i]) < min_range_m_) continue;
      rows.push_back({uint32_t(i), kLeastDistances[(bits >> 32) % std::size(kLeastDistances)]});
    }
    constexpr size_t kPiece = 1024;
    std::vector<std::vector<WeightSample>> found((rows.size() + kPiece - 1) / kPiece);
    parallel_for(rows.size(), kPiece, [&](size_t begin, size_t end) {
      found[begin / kPiece] = look_up(chunk, {rows.data() + begin, end - begin});
    });
    for (const auto& piece : found) samples.insert(samples.end(), piece.begin(), piece.end());
  }

 private:
  /// The rule of the held-out beams if they are enough.
  static credit::HeldOut usable(const KeyframeOptions& options, size_t beams) {
    const bool enough =
        options.held_out.one_in > 0 && beams / options.held_out.one_in >= options.samples / 4;
    return enough ? options.held_out : credit::HeldOut{0};
  }
  /// A beam of a chunk, and the least distance of the keyframes in which it is looked up, m.
  struct Row {
    uint32_t number;
    double least_m;
  };

  std::vector<WeightSample> look_up(const BeamLog& chunk, std::span<const Row> rows) const {
    std::vector<WeightSample> out;
    std::vector<Ray> rays;
    std::vector<double> range_m;
    std::vector<Vec3> origins;
    for (const Row& row : rows) origins.push_back(chunk.origin[row.number]);
    const std::vector<uint32_t> candidates = cache_.candidates(origins);
    std::vector<KeyframeCache::Query> beams;
    for (const auto& [i, least_m] : rows) beams.push_back(query(chunk, i, candidates, least_m));
    const std::vector<CachedPixels> found = cache_.look_up(beams);
    for (size_t k = 0; k < rows.size(); ++k) {
      if (found[k].count == 0) continue;
      const size_t i = rows[k].number;
      range_m.push_back(chunk.is_hit(i) ? double(chunk.range_m[i]) : HUGE_VAL);
      out.emplace_back(found[k], range_m.back());
      rays.push_back(beams[k].ray);
    }
    trace::IntersectionLists met;
    world_.all_intersections(rays, limits_, std::vector<double>(rays.size(), reach_m_), met);
    constexpr trace::OutlierShares kOutliers = trace::kReportedOutliers;
    trace::RangeMixture p;
    for (size_t k = 0; k < out.size(); ++k) {
      trace::mix_ranges(met[k], 1, 1e-4, p);
      out[k].elements = p.likelihood(range_m[k]);
      out[k].outlier =
          kOutliers.likelihood(std::isfinite(range_m[k]), max_range_m_) / kOutliers.explained();
    }
    return out;
  }

  KeyframeCache::Query query(const BeamLog& chunk, size_t i, std::span<const uint32_t> candidates,
                             double least_m) const {
    const Ray ray = chunk.ray(i);
    if (is_one_scan_) return {ray, cache_.near(ray.origin, candidates), 0};
    const auto frame = frame_of_scan_.find(chunk.scan[i]);
    const bool is_frame = frame != frame_of_scan_.end();
    const uint32_t own = is_frame ? frame->second : KeyframeCache::Near::kNone;
    return {ray, cache_.near(ray.origin, candidates, least_m, own), 0};
  }

  bool is_one_scan_;
  const std::map<uint32_t, uint32_t>& frame_of_scan_;
  trace::World world_;
  KeyframeCache cache_;
  double min_range_m_, max_range_m_, reach_m_;
  trace::RangeLimits limits_;
  credit::HeldOut held_out_;
  uint64_t one_in_, row_ = 0;
};

/// The beams in every second column of the image of the only scan, from column `first` on.
class AlternateColumns : public BeamSource {
 public:
  AlternateColumns(BeamSource& source, const Keyframes& image, size_t first)
      : source_(source),
        sensor_from_world_(image.frames[0].sensor_from_world),
        grid_(image),
        first_(first) {}
  const LogInfo& info() const override { return source_.info(); }
  size_t size() const override { return source_.size() / 2; }
  void rewind() override { source_.rewind(); }
  bool next(BeamLog& chunk) override {
    BeamLog all;
    while (source_.next(all)) {
      chunk = all.like();
      for (size_t i = 0; i < all.size(); ++i) {
        const Vec3 d = sensor_from_world_ * all.direction[i].cast<double>();
        if (size_t(grid_.place(d).column) % 2 == first_) chunk.append(all, i);
      }
      if (!chunk.empty()) return true;
    }
    chunk = all;
    return false;
  }

 private:
  BeamSource& source_;
  Eigen::Quaterniond sensor_from_world_;
  elements::KeyframeGrid grid_;
  size_t first_;
};

/// Beams of a log, looked up in the keyframes of a model.
std::vector<WeightSample> samples_of(const elements::Model& model,
                                     const std::map<uint32_t, uint32_t>& frame_of_scan,
                                     BeamSource& log, const KeyframeOptions& options) {
  Sampler sampler(model, frame_of_scan, log.info(), log.size(), options);
  std::vector<WeightSample> samples;
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) sampler.add(chunk, samples);
  return samples;
}

/// Samples from a log of one scan: the beams of each half of its columns, which are looked up in an
/// image of the other half.
std::vector<WeightSample> samples_between_columns(elements::Model& model, BeamSource& log,
                                                  const KeyframeOptions& options) {
  const std::shared_ptr<const Keyframes> whole = model.keyframes;
  std::vector<WeightSample> samples;
  for (const size_t first : {0, 1}) {
    AlternateColumns shown(log, *whole, first), between(log, *whole, 1 - first);
    KeyframeImages half = make_half_images(shown, *whole, model.origin, options);
    model.keyframes = std::make_shared<Keyframes>(std::move(half.keyframes));
    const std::vector<WeightSample> more = samples_of(model, half.frame_of_scan, between, options);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  model.keyframes = whole;
  return samples;
}

/// The part of the elements' weight that is left where pixels are twice as near. The chance that a
/// surface ends between a beam and a pixel falls with the angle between them, though a little
/// slower: chosen within the training halves of two single scans, where 0.55 to 0.65 is best.
constexpr double kOfHalfTheAngle = 0.6;

/// The weights of pixels of one keyframe that are twice as near as those it was learnt from.
void bring_nearer(elements::KeyframeWeights& t) {
  const auto other = t.pixel.begin() + Keyframes::kPixelsOfFrame;
  const double seen = std::accumulate(t.pixel.begin(), other, 0.0);
  if (!(seen > 0)) return;
  const double raised = (1 - kOfHalfTheAngle * (1 - seen)) / seen;
  t.elements *= kOfHalfTheAngle;
  std::for_each(t.pixel.begin(), other, [&](double& r) { r *= raised; });
  std::for_each(other, t.pixel.end(), [&](double& r) { r *= kOfHalfTheAngle; });
}

}  // namespace

void learn_keyframes(elements::Model& model, BeamSource& log, const KeyframeOptions& options) {
  model.keyframes.reset();
  if (!(options.spacing_m > 0)) return;
  KeyframeImages images = make_keyframe_images(log, model.origin, options);
  if (images.keyframes.frames.empty()) return;
  const auto keyframes = std::make_shared<Keyframes>(std::move(images.keyframes));
  model.keyframes = keyframes;
  if (images.frame_of_scan.size() > 1) {
    keyframes->weights = most_likely_weights(samples_of(model, images.frame_of_scan, log, options));
  } else {
    keyframes->weights = most_likely_weights(samples_between_columns(model, log, options));
    for (elements::KeyframeWeights& t : keyframes->weights) bring_nearer(t);
  }
  keyframes->check();
  const auto has_weight = [](const elements::KeyframeWeights& t) { return t.elements < 1; };
  if (std::ranges::none_of(keyframes->weights, has_weight)) model.keyframes.reset();
}

KeyframeChanges update_keyframes(elements::Model& model, BeamSource& log,
                                 const KeyframeOptions& options, const elements::Model& changed) {
  KeyframeChanges out;
  if (!model.keyframes || model.keyframes->frames.empty() || !(options.spacing_m > 0)) {
    learn_keyframes(model, log, options);
    out.added = model.keyframes ? model.keyframes->frames.size() : 0;
    return out;
  }
  Keyframes earlier = *model.keyframes;
  model.keyframes.reset();
  out.forgotten_pixels = forget_changed(earlier, changed);
  KeyframeImages images = add_keyframe_images(log, std::move(earlier), model.origin, options);
  out.added = images.frame_of_scan.size();
  out.kept = images.keyframes.frames.size() - out.added;
  const auto keyframes = std::make_shared<Keyframes>(std::move(images.keyframes));
  model.keyframes = keyframes;
  keyframes->weights = most_likely_weights(samples_of(model, images.frame_of_scan, log, options),
                                           &keyframes->weights);
  keyframes->check();
  return out;
}

}  // namespace underbrush::keyframes
