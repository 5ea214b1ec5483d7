/// \file
/// What the keyframes of a model say of a beam that is fired near them.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/core/ray.hpp"
#include "underbrush/elements/model.hpp"
#include "underbrush/keyframes/glance.hpp"
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::keyframes {

/// The pixels that a beam sees in the keyframes next to it.
struct Recalled {
  static constexpr size_t kMost = elements::KeyframeTrust::kPixels;

  size_t count = 0;
  std::array<double, kMost> range_m{};  ///< Along the beam, m; infinite for a pixel without return.
  std::array<float, kMost> intensity{};
  std::array<uint8_t, kMost> rank{};  ///< The pixel's place in `KeyframeTrust::pixel`.
  size_t situation = 0;               ///< Index in `Keyframes::trust`.
};

/// The answer of the keyframes to a beam; a miss has an infinite range.
struct RecalledReturn {
  double range_m;
  float intensity;
  float mean_intensity;  ///< The mean over the pixels that saw the same surface.
};

/// The keyframes of a model, ready for beams, which see their pixels as `glance` says.
class Recollection {
 public:
  /// The keyframes nearest to a place; `distance_m` is that of the nearest one.
  struct Near {
    static constexpr uint32_t kNone = 0xffffffffu;
    std::array<uint32_t, elements::Keyframes::kFrames> frame{kNone, kNone};
    double distance_m = HUGE_VAL;
  };

  /// `model` must outlive it. Without keyframes nothing is recalled.
  explicit Recollection(const elements::Model& model);

  /// Whether there is something to recall for a log: the model has keyframes, and its sensor is
  /// that of the log. Another sensor would have missed other beams.
  static bool serves(const elements::Model& model, const LogInfo& beams);
  /// The keyframes that may be the nearest ones to one of some places (world, m).
  std::vector<uint32_t> candidates(std::span<const Vec3> origins) const;
  /// Finds the nearest of some keyframes to a place (world, m). Those nearer than `least_m` do not
  /// count, and neither does `except`.
  Near near(const Vec3& origin, std::span<const uint32_t> among, double least_m = 0,
            uint32_t except = Near::kNone) const;
  /// A beam that looks at keyframes.
  struct Asked {
    Ray ray;  ///< World.
    Near near{};
    double u = 0;  ///< Unless 0, nothing is seen where `drawn` would give nothing for this number.
  };
  /// Beams of some channels with the keyframes nearest to their origins; with none where the
  /// keyframes do not have the channel.
  std::vector<Asked> asked(std::span<const Ray> rays, std::span<const uint16_t> rings) const;
  /// What some beams see. The answer to one does not depend on the others.
  std::vector<Recalled> recall(std::span<const Asked> beams) const;

  const elements::KeyframeTrust& trust(const Recalled& r) const {
    return keyframes_->trust[r.situation];
  }
  /// Draws from the mixture of `KeyframeTrust`; nothing where the elements are to answer. `u`, even
  /// in [0, 1), decides what is seen, and `noise` the error of its range.
  std::optional<RecalledReturn> drawn(const Recalled& r, double u, uint64_t noise) const;
  /// What the pixel number `k` of those seen answers, without an error of its own.
  static RecalledReturn seen_by(const Recalled& r, size_t k);
  /// The most that `drawn` recalls at such a distance: the elements answer for any `u` from here
  /// on, without a look.
  double most_recalled(const Near& near) const {
    const size_t bin = distance_bin(near);
    return bin < most_recalled_.size() ? most_recalled_[bin] : 0;
  }
  /// The number, over all keyframes, of the patch of pixels in which the nearest one sees a point
  /// (world, m). Beams that end in a patch choose alike, as neighbours on one surface do.
  uint64_t patch_of(const Vec3& point, const Near& near) const;
  /// Mixes the answer `p` of the elements with what is recalled.
  void mix(const Recalled& r, trace::RangeMixture& p) const;

 private:
  static size_t distance_bin(const Near& near);
  /// Some beams look at one keyframe.
  void look(std::span<const Asked> beams, std::span<const uint32_t> which, uint32_t frame,
            size_t slot, std::vector<Recalled>& out) const;
  void see(const Asked& beam, uint32_t frame, size_t slot, const Glances& glances, size_t lane,
           Recalled& out) const;

  const elements::Model& model_;
  const elements::Keyframes* keyframes_;
  std::optional<elements::KeyframeGrid> grid_;
  std::optional<GlanceGrid> glance_grid_;
  std::array<double, elements::Keyframes::kDistances.size()> most_recalled_{},
      most_of_returns_{};  ///< Where at most half of the pixels seen did not return.
};

}  // namespace underbrush::keyframes
