#include "underbrush/keyframes/keyframe_weights.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "underbrush/core/clones.hpp"
#include "underbrush/core/eight_lanes.inl"
#include "underbrush/core/parallel.hpp"

namespace underbrush::keyframes {
namespace {

using elements::Keyframes;
using elements::KeyframeWeights;

constexpr size_t kPixels = KeyframeWeights::kPixels, kScales = KeyframeWeights::kScales;
static_assert(kPixels == kLanes);
/// The places of the pixels of the nearest keyframe, and of the next one.
constexpr uint8_t kFirstFrame = 0x0f, kSecondFrame = 0xf0;
/// Most accelerated rounds of an expectation and maximisation, and the largest change of a weight
/// in a step at which they end.
constexpr int kWeightRounds = 40;
constexpr double kSettled = 1e-4;
/// A distance at which fewer beams were looked up gets no weights of its own.
constexpr size_t kLeastBeams = 1000;
/// Beams' worth of the weights of all distances that are mixed into those of one.
constexpr double kPriorBeams = 50;
constexpr double kLeastSigma = 0.003, kLargestSigma = 0.6;  // m

/// The sums of an expectation over some samples, for one situation: of the shares of the elements,
/// of the pixels, of the scales, and of these times the squared distance.
struct Expected {
  double likelihood = 0;  ///< Sum of ln f of the samples.
  double elements = 0;
  std::array<double, kPixels> pixel{};
  std::array<double, kScales> scale{}, square_m2{};

  void add(const Expected& other) {
    likelihood += other.likelihood;
    elements += other.elements;
    for (size_t r = 0; r < kPixels; ++r) pixel[r] += other.pixel[r];
    for (size_t c = 0; c < kScales; ++c) {
      scale[c] += other.scale[c];
      square_m2[c] += other.square_m2[c];
    }
  }
};

/// Sums of floats in eight places. The halves are vectors of their own, because GCC 12 converts
/// eight floats to doubles one by one for instruction sets before AVX-512.
struct Doubles {
  typedef double Half __attribute__((vector_size(32)));
  Half low{}, high{};

  UNDERBRUSH_INLINE void add_low(F x) {
    low += __builtin_convertvector(__builtin_shufflevector(x, x, 0, 1, 2, 3), Half);
  }
  UNDERBRUSH_INLINE void add_high(F x) {
    high += __builtin_convertvector(__builtin_shufflevector(x, x, 4, 5, 6, 7), Half);
  }
  UNDERBRUSH_INLINE double operator[](size_t r) const {
    return r < kPixels / 2 ? low[r] : high[r - kPixels / 2];
  }
  /// The sum of all places, in their order.
  UNDERBRUSH_INLINE double sum() const {
    double sum = 0;
    for (size_t r = 0; r < kPixels; ++r) sum += (*this)[r];
    return sum;
  }
};

/// The sum of eight numbers in their order.
UNDERBRUSH_INLINE double sum_of(F x) {
  double sum = 0;
  for (size_t r = 0; r < kPixels; ++r) sum += double(x[r]);
  return sum;
}

/// The sum of eight numbers over each set of them, in their order. A set is a number with a bit for
/// each of its members.
class SetSums {
 public:
  explicit SetSums(const F& x) {
    for (size_t set = 1; set < sum_.size(); ++set) {
      const size_t last = size_t(std::bit_width(set)) - 1;
      sum_[set] = sum_[set ^ size_t(1) << last] + double(x[last]);
    }
  }
  double operator[](uint8_t set) const { return sum_[set]; }

 private:
  std::array<double, 1 << kPixels> sum_{};
};

/// The numbers of a set, and 0 for all others.
UNDERBRUSH_INLINE F only(uint8_t set, F x) {
  constexpr I kBits{1, 2, 4, 8, 16, 32, 64, 128};
  return (F)((I)x & ((kBits & int32_t(set)) != 0));
}

/// Adds the shares of `n` samples, each in all places of `KeyframeWeights::pixel` at once. The sum
/// of ln f, for which products of many f are taken, is added only `with_likelihood`.
// long: a loop whose sums stay in registers
UNDERBRUSH_CLONES void expect(const WeightSample* samples, const uint32_t* which, size_t n,
                              const KeyframeWeights& t, bool with_likelihood, Expected& out) {
  F pixel, exponent[kScales], peak[kScales], scaled[kScales], of_miss{};
  for (size_t r = 0; r < kPixels; ++r) pixel[r] = float(t.pixel[r]);
  for (size_t c = 0; c < kScales; ++c) {
    const auto sigma = float(t.sigma_m[c]);
    exponent[c] = all(-0.5f / (sigma * sigma));
    peak[c] = all(1 / (float(std::sqrt(2 * M_PI)) * sigma));
    scaled[c] = pixel * float(t.scale[c]);
    of_miss += scaled[c];
  }
  const SetSums unseen_sums(pixel), miss_sums(of_miss);
  Doubles pixels, scales[kScales], squares[kScales];
  double product = 1, elements = 0;
  for (size_t i = 0; i < n; ++i) {
    const WeightSample& s = samples[which[i]];
    // A beam that missed has no pixel in which both returned, and the other way round.
    const F off = load(s.off_m.data()), square = off * off;
    F part[kScales], sum = only(s.missed, of_miss);
    double of_pixels = miss_sums[s.missed];
    if (s.hit != 0) {
      sum = F{};
      for (size_t c = 0; c < kScales; ++c) {
        const F bell = peak[c] * exp_below_zero(exponent[c] * square);
        part[c] = scaled[c] * only(s.hit, bell);
        sum += part[c];
      }
      of_pixels = sum_of(sum);
    }
    const double of_elements = t.elements + unseen_sums[s.unseen];
    const double total = s.outlier + of_elements * s.elements + of_pixels;
    if (!(total > 0)) continue;
    if (with_likelihood && ((product *= total) < 1e-100 || product > 1e100)) {
      out.likelihood += std::log(std::exchange(product, 1));
    }
    // A pixel that a beam does not find has the density of the elements, with its own weight.
    elements += t.elements * s.elements / total;
    const auto one = float(1 / total);
    const F unseen = only(s.unseen, pixel);
    const F shares = one * (sum + unseen * float(s.elements));
    pixels.add_low(shares);
    pixels.add_high(shares);
    if (s.hit == 0) continue;
    for (size_t c = 0; c < kScales; ++c) {
      const F share = one * part[c];
      if (s.hit & kFirstFrame) {
        scales[c].add_low(share);
        squares[c].add_low(share * square);
      }
      if (s.hit & kSecondFrame) {
        scales[c].add_high(share);
        squares[c].add_high(share * square);
      }
    }
  }
  out.likelihood += std::log(product);
  out.elements += elements;
  for (size_t r = 0; r < kPixels; ++r) out.pixel[r] += pixels[r];
  for (size_t c = 0; c < kScales; ++c) {
    out.scale[c] += scales[c].sum();
    out.square_m2[c] += squares[c].sum();
  }
}

/// The weights that follow from sums and from `beams` beams with the weights of `prior`.
KeyframeWeights weights_of(const Expected& sums, const KeyframeWeights& prior, double beams) {
  KeyframeWeights out = prior;
  double all = sums.elements, returns = 0;
  for (const double w : sums.pixel) all += w;
  for (const double c : sums.scale) returns += c;
  out.elements = (sums.elements + beams * prior.elements) / (all + beams);
  for (size_t r = 0; r < kPixels; ++r) {
    out.pixel[r] = (sums.pixel[r] + beams * prior.pixel[r]) / (all + beams);
  }
  for (size_t c = 0; c < kScales; ++c) {
    const double number = sums.scale[c] + beams * prior.scale[c];
    const double square =
        sums.square_m2[c] + beams * prior.scale[c] * prior.sigma_m[c] * prior.sigma_m[c];
    out.scale[c] = number / (returns + beams);
    if (number > 0) {
      out.sigma_m[c] = std::clamp(std::sqrt(square / number), kLeastSigma, kLargestSigma);
    }
  }
  return out;
}

KeyframeWeights first_guess() {
  KeyframeWeights t;
  t.elements = 0.3;
  t.pixel.fill(0.7 / double(t.pixel.size()));
  t.scale.fill(1.0 / double(t.scale.size()));
  t.sigma_m = {0.02, 0.1, 0.5};
  return t;
}

/// The members of `KeyframeWeights` as one vector, and back; a step beyond their limits ends at
/// them.
using WeightVector = Eigen::Array<double, 1 + kPixels + 2 * kScales, 1>;

WeightVector vector_of(const KeyframeWeights& t) {
  WeightVector v;
  v[0] = t.elements;
  for (size_t r = 0; r < kPixels; ++r) v[int(1 + r)] = t.pixel[r];
  for (size_t c = 0; c < kScales; ++c) {
    v[int(1 + kPixels + c)] = t.scale[c];
    v[int(1 + kPixels + kScales + c)] = t.sigma_m[c];
  }
  return v;
}

KeyframeWeights weights_of(const WeightVector& v) {
  constexpr double kLeast = 1e-9;
  const WeightVector w = v.max(kLeast);
  const double weights = w.head<1 + kPixels>().sum(),
               scales = w.segment<kScales>(1 + kPixels).sum();
  KeyframeWeights t;
  t.elements = w[0] / weights;
  for (size_t r = 0; r < kPixels; ++r) t.pixel[r] = w[int(1 + r)] / weights;
  for (size_t c = 0; c < kScales; ++c) {
    t.scale[c] = w[int(1 + kPixels + c)] / scales;
    t.sigma_m[c] = std::clamp(w[int(1 + kPixels + kScales + c)], kLeastSigma, kLargestSigma);
  }
  return t;
}

/// An expectation and a maximisation of the weights in the samples of some situations.
class WeightStep {
 public:
  WeightStep(const std::vector<WeightSample>& samples, const std::vector<uint32_t>& which,
             const KeyframeWeights& prior, double prior_beams)
      : samples_(samples), which_(which), prior_(prior), prior_beams_(prior_beams) {}

  /// Returns the next weights; `likelihood`, if it is given, becomes that of `t`.
  KeyframeWeights operator()(const KeyframeWeights& t, double* likelihood = nullptr) const {
    constexpr size_t kPiece = 4096;
    std::vector<Expected> pieces((which_.size() + kPiece - 1) / kPiece);
    parallel_for(which_.size(), kPiece, [&](size_t begin, size_t end) {
      expect(samples_.data(), which_.data() + begin, end - begin, t, likelihood != nullptr,
             pieces[begin / kPiece]);
    });
    Expected all;
    for (const Expected& piece : pieces) all.add(piece);
    if (likelihood) *likelihood = all.likelihood;
    return weights_of(all, prior_, prior_beams_);
  }

 private:
  const std::vector<WeightSample>& samples_;
  const std::vector<uint32_t>& which_;
  const KeyframeWeights& prior_;
  double prior_beams_;
};

/// Maximises the likelihood of the samples of some situations. For most beams, such as those into
/// the sky, elements and pixels have the same likelihood. These beams do not change the maximum,
/// but make the steps short. Two steps are therefore extrapolated by squares (SQUAREM [varadhan08])
/// as long as this raises the likelihood.
KeyframeWeights most_likely(const std::vector<WeightSample>& samples,
                            const std::vector<uint32_t>& which, const KeyframeWeights& prior,
                            double prior_beams) {
  const WeightStep step(samples, which, prior, prior_beams);
  KeyframeWeights t = prior;
  for (int round = 0; round < kWeightRounds; ++round) {
    double after = 0, extrapolated = 0;
    const KeyframeWeights one = step(t), two = step(one, &after);
    const WeightVector v0 = vector_of(t), v1 = vector_of(one), v2 = vector_of(two);
    const WeightVector change = v1 - v0, bend = v2 - v1 - change;
    t = two;
    if (change.abs().maxCoeff() < kSettled) break;
    const double norm = bend.matrix().norm();
    if (!(norm > 0)) break;
    const double length = std::max(1.0, change.matrix().norm() / norm);
    const KeyframeWeights far = weights_of(v0 + 2 * length * change + length * length * bend);
    const KeyframeWeights next = step(far, &extrapolated);
    if (extrapolated >= after) t = next;
  }
  return t;
}

/// The places of `KeyframeWeights::pixel` for which some samples have no evidence, because no more
/// than a few found a pixel there.
std::array<bool, kPixels> unseen_by(const std::vector<WeightSample>& samples,
                                    const std::vector<uint32_t>& which) {
  std::array<double, kPixels> seen{};
  for (const uint32_t i : which) {
    for (size_t r = 0; r < kPixels; ++r) seen[r] += 1 - (samples[i].unseen >> r & 1);
  }
  std::array<bool, kPixels> out;
  for (size_t r = 0; r < kPixels; ++r) out[r] = seen[r] < kPriorBeams;
  return out;
}

/// Gives the elements the weight of pixels that nothing was learnt of.
void leave_to_elements(const std::array<bool, kPixels>& unseen, KeyframeWeights& t) {
  for (size_t r = 0; r < kPixels; ++r) {
    if (unseen[r]) t.elements += std::exchange(t.pixel[r], 0.0);
  }
}

}  // namespace

WeightSample::WeightSample(const CachedPixels& found, double range_m) : situation(found.situation) {
  const bool beam_missed = std::isinf(range_m);
  for (size_t k = 0; k < found.count; ++k) {
    const size_t r = found.rank[k];
    const bool pixel_missed = std::isinf(found.range_m[k]);
    const auto bit = uint8_t(1 << r);
    unseen &= uint8_t(~bit);
    if (pixel_missed && beam_missed) missed |= bit;
    if (pixel_missed || beam_missed) continue;
    hit |= bit;
    off_m[r] = float(range_m - found.range_m[k]);
  }
}

std::array<KeyframeWeights, Keyframes::kSituations> most_likely_weights(
    const std::vector<WeightSample>& samples,
    const std::array<KeyframeWeights, Keyframes::kSituations>* earlier) {
  std::array<KeyframeWeights, Keyframes::kSituations> out;
  std::vector<std::vector<uint32_t>> by_situation(Keyframes::kSituations);
  std::vector<std::vector<uint32_t>> by_agreement(Keyframes::kAgreements);
  for (uint32_t i = 0; i < samples.size(); ++i) {
    by_situation[samples[i].situation].push_back(i);
    by_agreement[samples[i].situation % Keyframes::kAgreements].push_back(i);
  }
  const KeyframeWeights start = first_guess();
  constexpr size_t kDistances = Keyframes::kDistances.size();
  const auto situation_of = [](size_t distance, size_t agreement) {
    return distance * Keyframes::kAgreements + agreement;
  };
  std::array<bool, kDistances> is_known{};
  for (size_t d = 0; d < kDistances; ++d) {
    size_t beams = 0;
    for (size_t a = 0; a < Keyframes::kAgreements; ++a) {
      beams += by_situation[situation_of(d, a)].size();
    }
    is_known[d] = beams >= kLeastBeams;
  }
  parallel_for(Keyframes::kAgreements, 1, [&](size_t a, size_t) {
    const KeyframeWeights pooled = most_likely(samples, by_agreement[a], start, 1);
    const std::array<bool, kPixels> unseen = unseen_by(samples, by_agreement[a]);
    parallel_for(kDistances, 1, [&](size_t d, size_t) {
      if (!is_known[d]) return;
      KeyframeWeights& t = out[situation_of(d, a)];
      t = most_likely(samples, by_situation[situation_of(d, a)], pooled, kPriorBeams);
      leave_to_elements(unseen, t);
    });
    // Where no beam was so near to a keyframe, the weights are those of the next farther distance.
    for (size_t d = kDistances; d-- > 0;) {
      const size_t situation = situation_of(d, a);
      if (is_known[d]) continue;
      if (earlier) {
        out[situation] = (*earlier)[situation];
      } else if (d + 1 < kDistances) {
        out[situation] = out[situation_of(d + 1, a)];
      }
    }
  });
  return out;
}

}  // namespace underbrush::keyframes
