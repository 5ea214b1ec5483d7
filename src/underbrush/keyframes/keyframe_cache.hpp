/// \file
/// The keyframes of a model as a cache of measured returns that is queried for beams.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/ray.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/keyframes/pixel_look_up.hpp"
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::keyframes {

/// The pixels of the nearest keyframes whose points lie on a beam.
struct CachedPixels {
  static constexpr size_t kMost = elements::KeyframeWeights::kPixels;

  size_t count = 0;
  std::array<double, kMost> range_m{};  ///< Range along the beam, m; infinite without a return.
  std::array<float, kMost> intensity{};
  std::array<uint8_t, kMost> rank{};  ///< The pixel's place in `KeyframeWeights::pixel`.
  size_t situation = 0;               ///< Index in `Keyframes::weights`.
};

/// The return of one pixel for a beam; a miss has an infinite range.
struct CachedReturn {
  double range_m;
  float intensity;
  float mean_intensity;  ///< The mean over the pixels of the same surface.
};

/// The keyframes of a model. `look_up_pixels` defines which pixels belong to a beam.
class KeyframeCache {
 public:
  /// The keyframes nearest to a place; `distance_m` is that of the nearest one.
  struct Near {
    static constexpr uint32_t kNone = 0xffffffffu;
    std::array<uint32_t, elements::Keyframes::kFrames> frame{kNone, kNone};
    double distance_m = HUGE_VAL;
  };

  /// `model` must outlive it. Without keyframes no pixel is found.
  explicit KeyframeCache(const elements::Model& model);

  /// Whether the cache serves the beams of a log: the model has keyframes, and its sensor is that
  /// of the log. Another sensor would have missed other beams. Sensors are distinguished by their
  /// names; where neither has one, the log is read to compare its beams with the pixels
  /// (`is_of_sensor`). The log is rewound before and after.
  static bool serves(const elements::Model& model, BeamSource& log);
  /// Compares the names of the sensors only; two logs without a name count as equal.
  static bool serves(const elements::Model& model, const LogInfo& beams);
  /// The keyframes that may be the nearest ones to one of some places (world, m).
  std::vector<uint32_t> candidates(std::span<const Vec3> origins) const;
  /// Finds those of some keyframes (`among`) that are nearest to a place (world, m) and not farther
  /// than the last of `Keyframes::kDistances`. Keyframes nearer than `least_m` and the keyframe
  /// `except` are left out.
  Near near(const Vec3& origin, std::span<const uint32_t> among, double least_m = 0,
            uint32_t except = Near::kNone) const;
  /// A beam whose pixels are looked up.
  struct Query {
    Ray ray;  ///< World.
    Near near{};
    /// The `u` of `drawn`. A look-up ends early and finds nothing where `drawn` would select no
    /// pixel for this number; 0 = no look-up ends early.
    double u = 0;
  };
  /// Makes queries of beams of some channels, with the keyframes nearest to their origins, or with
  /// none where the keyframes do not have the channel.
  std::vector<Query> queries(std::span<const Ray> rays, std::span<const uint16_t> rings) const;
  /// Finds the pixels of each query. The result of a query does not depend on the other queries.
  std::vector<CachedPixels> look_up(std::span<const Query> beams) const;

  const elements::KeyframeWeights& weights(const CachedPixels& r) const {
    return keyframes_->weights[r.situation];
  }
  /// Draws from the mixture of `KeyframeWeights`. The result is empty if the return comes from the
  /// elements. `u`, even in [0, 1), selects the pixel, and `noise` is the key of the error of its
  /// range.
  std::optional<CachedReturn> drawn(const CachedPixels& r, double u, uint64_t noise) const;
  /// The return of pixel `k` of those found, without an error of its own.
  static CachedReturn return_of(const CachedPixels& r, size_t k);
  /// The greatest weight of all pixels together at the distance of `near`. For any `u` not below
  /// it, the return comes from the elements, without a query.
  double greatest_weight(const Near& near) const {
    const size_t bin = distance_bin(near);
    return bin < greatest_weight_.size() ? greatest_weight_[bin] : 0;
  }
  /// The number, over all keyframes, of the patch of pixels of the nearest one that holds a point
  /// (world, m). Beams that end in one patch share their draws, as neighbours on one surface do.
  uint64_t patch_of(const Vec3& point, const Near& near) const;
  /// Mixes the distribution `p` of the elements with that of the pixels.
  void mix(const CachedPixels& r, trace::RangeMixture& p) const;

 private:
  static size_t distance_bin(const Near& near);
  /// The keyframes that may be the two nearest ones to one of some places (world, m).
  std::vector<uint32_t> nearest_candidates(std::span<const Vec3> origins) const;
  /// Looks some beams up in one keyframe and adds the pixels found.
  void look_up_in(std::span<const Query> beams, std::span<const uint32_t> which, uint32_t frame,
                  size_t slot, std::vector<CachedPixels>& out) const;
  void add_pixels(const Query& beam, uint32_t frame, size_t slot, const PixelLookUp& found,
                  size_t lane, CachedPixels& out) const;

  const elements::Model& model_;
  const elements::Keyframes* keyframes_;
  std::optional<elements::KeyframeGrid> grid_;
  std::optional<LookUpGrid> look_up_grid_;
  std::array<double, elements::Keyframes::kDistances.size()> greatest_weight_{},
      greatest_weight_of_returns_{};  ///< Greatest weight if at most half of the pixels are misses.
};

}  // namespace underbrush::keyframes
