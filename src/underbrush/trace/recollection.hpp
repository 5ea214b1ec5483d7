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
#include "underbrush/trace/ray_likelihood.hpp"

namespace underbrush::trace {

/// The pixels that a beam sees in the keyframes next to it.
struct Recalled {
  static constexpr size_t kMost = elements::KeyframeTrust::kPixels;

  size_t count = 0;
  std::array<double, kMost> range_m{};  ///< Along the beam, m; infinite for a pixel without return.
  std::array<float, kMost> intensity{};
  std::array<uint8_t, kMost> rank{};  ///< The pixel's place in `KeyframeTrust::pixel`.
  uint64_t nearest = 0;               ///< Number of the nearest pixel over all keyframes.
  size_t situation = 0;               ///< Index in `Keyframes::trust`.
};

/// The answer of the keyframes to a beam; a miss has an infinite range.
struct RecalledReturn {
  double range_m;
  float intensity;
  float mean_intensity;  ///< The mean over the pixels that saw the same surface.
};

/// The keyframes of a model, ready for beams.
///
/// A beam from elsewhere sees a pixel where the point of that pixel lies on the beam. It is found
/// by fixed-point iteration: the pixel in the direction of a point on the beam gives the next
/// point, until the pixel stays the same. Seen are the four pixels nearest to that direction, in
/// order of their angle from it.
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
  bool serves(const LogInfo& beams) const;
  /// The keyframes that may be the nearest ones to one of some places (world, m).
  std::vector<uint32_t> candidates(std::span<const Vec3> origins) const;
  /// Finds the nearest of some keyframes to a place (world, m). Those nearer than `least_m` do not
  /// count, and neither does `except`.
  Near near(const Vec3& origin, std::span<const uint32_t> among, double least_m = 0,
            uint32_t except = Near::kNone) const;
  /// Looks along a beam (world). Unless `own` is null, the pixels of that end point (world, m) or,
  /// where it is not finite, the nearest one are overlooked, because they are the beam itself.
  Recalled recall(const Ray& ray, const Near& near, const Vec3* own = nullptr) const;

  const elements::KeyframeTrust& trust(const Recalled& r) const {
    return keyframes_->trust[r.situation];
  }
  /// Draws from the mixture of `KeyframeTrust`; nothing where the elements are to answer. `choice`
  /// decides what is seen, and `noise` the error of its range.
  std::optional<RecalledReturn> drawn(const Recalled& r, uint64_t choice, uint64_t noise) const;
  /// Mixes the answer `p` of the elements with what is recalled.
  void mix(const Recalled& r, RangeMixture& p) const;

 private:
  void look(const Vec3& from, const Vec3& direction, uint32_t frame, size_t slot, const Vec3* own,
            Recalled& out) const;
  class Nearest;
  /// Finds the pixels nearest to the direction of a point (relative to the keyframe's origin, m),
  /// among the nine about its place.
  void find(const elements::Keyframe& f, const Vec3& at, Nearest& out) const;

  const elements::Model& model_;
  const elements::Keyframes* keyframes_;
  std::optional<elements::KeyframeGrid> grid_;
};

}  // namespace underbrush::trace
