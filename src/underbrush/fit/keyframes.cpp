#include "underbrush/fit/keyframes.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/fit/keyframe_images.hpp"
#include "underbrush/trace/recollection.hpp"
#include "underbrush/trace/world.hpp"

namespace underbrush::fit {
namespace {

using elements::Keyframes;
using elements::KeyframeTrust;

constexpr int kTrustRounds = 15;
/// A distance at which fewer beams were looked at is not trusted.
constexpr size_t kLeastBeams = 1000;
/// Beams' worth of the weights of all distances that are mixed into those of one.
constexpr double kPriorBeams = 50;
constexpr double kLeastSigma = 0.003, kLargestSigma = 0.6;  // m
/// Beams look at the keyframes that are at least so far away, m.
constexpr double kLeastDistances[] = {0, 0, 0.5, 1, 2, 4};

/// A beam, what the elements say of its outcome, and what it sees in keyframes.
struct Sample {
  trace::Recalled seen;
  double range_m = 0;   // infinite for a miss
  double elements = 0;  // density (1/m) or probability of the outcome
  double outlier = 0;   // the part of the outliers in it
};

/// The density of a normal number.
double bell(double x, double sigma) {
  const double y = x / sigma;
  return y * y > 50 ? 0 : std::exp(-0.5 * y * y) / (std::sqrt(2 * M_PI) * sigma);
}

/// The sums of an expectation over some samples, for one situation.
struct Expected {
  KeyframeTrust weight{0, {}, {0, 0, 0}, {0, 0, 0}};    // sigma_m holds Σ r (z − z_k)²
  std::array<double, KeyframeTrust::kScales> ranges{};  // Σ r of returns

  void add(const Sample& s, const KeyframeTrust& t) {
    std::array<std::array<double, KeyframeTrust::kScales>, KeyframeTrust::kPixels> part{};
    double unseen = t.elements;
    for (const double w : t.pixel) unseen += w;
    for (size_t k = 0; k < s.seen.count; ++k) unseen -= t.pixel[s.seen.rank[k]];
    double total = unseen * s.elements + s.outlier;
    for (size_t k = 0; k < s.seen.count; ++k) {
      const double w = t.pixel[s.seen.rank[k]];
      const bool missed = std::isinf(s.seen.range_m[k]);
      if (missed != std::isinf(s.range_m)) continue;
      for (size_t c = 0; c < t.scale.size(); ++c) {
        const double f = missed ? 1 : bell(s.range_m - s.seen.range_m[k], t.sigma_m[c]);
        total += part[k][c] = w * t.scale[c] * f;
      }
    }
    if (!(total > 0)) return;
    // Pixels that a beam does not see leave their weight to the elements, and its share there.
    weight.elements += t.elements * s.elements / total;
    for (size_t r = 0; r < t.pixel.size(); ++r) {
      bool seen = false;
      for (size_t k = 0; k < s.seen.count; ++k) seen |= s.seen.rank[k] == r;
      if (!seen) weight.pixel[r] += t.pixel[r] * s.elements / total;
    }
    for (size_t k = 0; k < s.seen.count; ++k) {
      for (size_t c = 0; c < t.scale.size(); ++c) {
        const double share = part[k][c] / total;
        weight.pixel[s.seen.rank[k]] += share;
        if (std::isinf(s.range_m)) continue;
        const double off = s.range_m - s.seen.range_m[k];
        weight.scale[c] += share;
        weight.sigma_m[c] += share > 0 ? share * off * off : 0;
      }
    }
  }

  void add(const Expected& other) {
    weight.elements += other.weight.elements;
    for (size_t r = 0; r < weight.pixel.size(); ++r) weight.pixel[r] += other.weight.pixel[r];
    for (size_t c = 0; c < weight.scale.size(); ++c) {
      weight.scale[c] += other.weight.scale[c];
      weight.sigma_m[c] += other.weight.sigma_m[c];
    }
  }

  /// The weights that follow from the sums and from `beams` beams with the weights of `prior`.
  KeyframeTrust trust(const KeyframeTrust& prior, double beams) const {
    KeyframeTrust out = prior;
    double all = weight.elements, returns = 0;
    for (const double w : weight.pixel) all += w;
    for (const double c : weight.scale) returns += c;
    out.elements = (weight.elements + beams * prior.elements) / (all + beams);
    for (size_t r = 0; r < out.pixel.size(); ++r) {
      out.pixel[r] = (weight.pixel[r] + beams * prior.pixel[r]) / (all + beams);
    }
    for (size_t c = 0; c < out.scale.size(); ++c) {
      out.scale[c] = (weight.scale[c] + beams * prior.scale[c]) / (returns + beams);
      const double square =
          weight.sigma_m[c] + beams * prior.scale[c] * prior.sigma_m[c] * prior.sigma_m[c];
      const double number = weight.scale[c] + beams * prior.scale[c];
      if (number > 0)
        out.sigma_m[c] = std::clamp(std::sqrt(square / number), kLeastSigma, kLargestSigma);
    }
    return out;
  }
};

KeyframeTrust first_guess() {
  KeyframeTrust t;
  t.elements = 0.3;
  t.pixel.fill(0.7 / double(t.pixel.size()));
  t.scale.fill(1.0 / double(t.scale.size()));
  t.sigma_m = {0.02, 0.1, 0.5};
  return t;
}

/// Maximises the likelihood of the samples of some situations.
KeyframeTrust most_likely_trust(const std::vector<Sample>& samples,
                                const std::vector<uint32_t>& which, const KeyframeTrust& prior,
                                double prior_beams) {
  constexpr size_t kPiece = 4096;
  KeyframeTrust t = prior;
  for (int round = 0; round < kTrustRounds; ++round) {
    std::vector<Expected> pieces((which.size() + kPiece - 1) / kPiece);
    parallel_for(which.size(), kPiece, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) pieces[begin / kPiece].add(samples[which[i]], t);
    });
    Expected all;
    for (const Expected& piece : pieces) all.add(piece);
    t = all.trust(prior, prior_beams);
  }
  return t;
}

/// The trust in every situation. `samples` are in the order of the log.
void learn_trust(const std::vector<Sample>& samples, Keyframes& k) {
  std::vector<std::vector<uint32_t>> by_situation(Keyframes::kSituations);
  std::vector<std::vector<uint32_t>> by_agreement(Keyframes::kAgreements);
  for (uint32_t i = 0; i < samples.size(); ++i) {
    by_situation[samples[i].seen.situation].push_back(i);
    by_agreement[samples[i].seen.situation % Keyframes::kAgreements].push_back(i);
  }
  const KeyframeTrust start = first_guess();
  for (size_t a = 0; a < Keyframes::kAgreements; ++a) {
    const KeyframeTrust pooled = most_likely_trust(samples, by_agreement[a], start, 1);
    // Where no beam was so near to a keyframe, the trust is that of the next farther distance.
    KeyframeTrust farther;
    for (size_t d = Keyframes::kDistances.size(); d-- > 0;) {
      const size_t situation = d * Keyframes::kAgreements + a;
      size_t beams = 0;
      for (size_t b = 0; b < Keyframes::kAgreements; ++b) {
        beams += by_situation[d * Keyframes::kAgreements + b].size();
      }
      if (beams >= kLeastBeams) {
        farther = most_likely_trust(samples, by_situation[situation], pooled, kPriorBeams);
      }
      k.trust[situation] = farther;
    }
  }
}

/// Beams of a log that look at its keyframes.
class Sampler {
 public:
  Sampler(const elements::Model& model, const std::map<uint32_t, uint32_t>& frame_of_scan,
          const LogInfo& log, size_t beams, const KeyframeOptions& options)
      : frame_of_scan_(frame_of_scan),
        world_(model),
        recollection_(model),
        min_range_m_(options.min_range_m),
        max_range_m_(log.max_range_m),
        reach_m_(std::min(log.max_range_m, model.max_range_m)),
        limits_{log.min_range_m, reach_m_},
        one_in_(1 + beams / std::max<size_t>(options.samples, 1)) {}

  void add(const BeamLog& chunk, std::vector<Sample>& samples) {
    std::vector<Row> rows;
    for (size_t i = 0; i < chunk.size(); ++i) {
      const uint64_t bits = mix64(++row_);
      if (bits % one_in_ != 0) continue;
      if (chunk.is_hit(i) && double(chunk.range_m[i]) < min_range_m_) continue;
      rows.push_back({uint32_t(i), kLeastDistances[(bits >> 32) % std::size(kLeastDistances)]});
    }
    constexpr size_t kPiece = 1024;
    std::vector<std::vector<Sample>> found((rows.size() + kPiece - 1) / kPiece);
    parallel_for(rows.size(), kPiece, [&](size_t begin, size_t end) {
      found[begin / kPiece] = look(chunk, {rows.data() + begin, end - begin});
    });
    for (const auto& piece : found) samples.insert(samples.end(), piece.begin(), piece.end());
  }

 private:
  /// A beam of a chunk, and how far away the keyframes are at least that it looks at, m.
  struct Row {
    uint32_t number;
    double least_m;
  };

  std::vector<Sample> look(const BeamLog& chunk, std::span<const Row> rows) const {
    std::vector<Sample> out;
    std::vector<Ray> rays;
    std::vector<Vec3> origins;
    for (const Row& row : rows) origins.push_back(chunk.origin[row.number]);
    const std::vector<uint32_t> candidates = recollection_.candidates(origins);
    std::vector<trace::Recollection::Asked> beams;
    for (const auto& [i, least_m] : rows) beams.push_back(asked(chunk, i, candidates, least_m));
    const std::vector<trace::Recalled> seen = recollection_.recall(beams);
    for (size_t k = 0; k < rows.size(); ++k) {
      if (seen[k].count == 0) continue;
      const size_t i = rows[k].number;
      out.push_back({seen[k], chunk.is_hit(i) ? double(chunk.range_m[i]) : HUGE_VAL, 0, 0});
      rays.push_back(beams[k].ray);
    }
    trace::IntersectionLists met;
    world_.all_intersections(rays, limits_, std::vector<double>(rays.size(), reach_m_), met);
    constexpr trace::OutlierShares kOutliers = trace::kReportedOutliers;
    trace::RangeMixture p;
    for (size_t k = 0; k < out.size(); ++k) {
      trace::mix_ranges(met[k], 1, 1e-4, p);
      out[k].elements = p.likelihood(out[k].range_m);
      out[k].outlier =
          kOutliers.likelihood(std::isfinite(out[k].range_m), max_range_m_) / kOutliers.explained();
    }
    return out;
  }

  trace::Recollection::Asked asked(const BeamLog& chunk, size_t i,
                                   std::span<const uint32_t> candidates, double least_m) const {
    const Ray ray = chunk.ray(i);
    const auto frame = frame_of_scan_.find(chunk.scan[i]);
    const bool is_frame = frame != frame_of_scan_.end();
    const uint32_t own = is_frame ? frame->second : trace::Recollection::Near::kNone;
    if (frame_of_scan_.size() == 1) {
      const Vec3 point = chunk.is_hit(i) ? chunk.end_point(i) : Vec3::Constant(NAN);
      return {ray, recollection_.near(ray.origin, candidates), 0,
              is_frame ? std::optional(point) : std::nullopt};
    }
    return {ray, recollection_.near(ray.origin, candidates, least_m, own), 0, {}};
  }

  const std::map<uint32_t, uint32_t>& frame_of_scan_;
  trace::World world_;
  trace::Recollection recollection_;
  double min_range_m_, max_range_m_, reach_m_;
  trace::RangeLimits limits_;
  uint64_t one_in_, row_ = 0;
};

}  // namespace

void learn_keyframes(elements::Model& model, BeamSource& log, const KeyframeOptions& options) {
  model.keyframes.reset();
  if (!(options.spacing_m > 0)) return;
  KeyframeImages images = make_keyframe_images(log, model.origin, options);
  if (images.keyframes.frames.empty()) return;
  const auto keyframes = std::make_shared<Keyframes>(std::move(images.keyframes));
  model.keyframes = keyframes;
  std::vector<Sample> samples;
  Sampler sampler(model, images.frame_of_scan, log.info(), log.size(), options);
  log.rewind();
  for (BeamLog chunk; log.next(chunk);) sampler.add(chunk, samples);
  learn_trust(samples, *keyframes);
  keyframes->check();
}

}  // namespace underbrush::fit
