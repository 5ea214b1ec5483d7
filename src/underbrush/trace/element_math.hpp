/// \file
/// The ray model in double precision: which elements a ray meets and where. This is the definition
/// that every faster path must reproduce exactly.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "underbrush/core/ray.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush {
/// Which elements a beam meets, and which one stops it.
namespace trace {

/// A ray meeting an element.
struct Intersection {
  double t_m = 0;      ///< Range of the closest Mahalanobis approach, or of the intersection.
  double sigma_m = 0;  ///< σ of the range drawn on a hit.
  double delta2 = 0;   ///< Squared Mahalanobis distance of the closest approach; 0 for triangles.
  double p = 0;        ///< Probability that this meeting is a hit.
  uint32_t element = kNone;
  uint32_t instance = 0;  ///< Of the scene; 0 where the world is one model.

  static constexpr uint32_t kNone = 0xffffffffu;
  bool none() const { return element == kNone; }
  /// The order of visiting: by range, ties by instance and element.
  bool before(const Intersection& other) const {
    if (t_m != other.t_m) return t_m < other.t_m;
    return instance != other.instance ? instance < other.instance : element < other.element;
  }
};

/// Where along a ray elements count: t in [min_m, max_m].
struct RangeLimits {
  double min_m = 0;
  double max_m = 120;
};

/// The closest approach of a ray to a Gaussian, [deschaud12] eq. 1–3:
/// t = dᵀΣ⁻¹(μ−o) / dᵀΣ⁻¹d, δ² = |o + t d − μ|²_Σ, σ² = 1 / dᵀΣ⁻¹d.
/// `origin` and `mean` in one frame (m); `covariance` xx xy xz yy yz zz (m²), positive definite.
Intersection approach(const Vec3& origin, const Vec3& direction, const Vec3f& mean,
                      const std::array<float, 6>& covariance);

/// Range at which a ray crosses a triangle, either side, border included; none if it misses or runs
/// in its plane. Watertight: vertices are placed once per ray and the edge tests have exact signs
/// (Woop, Benthin & Wald 2013), so a mesh has no gap along its edges or at its vertices.
std::optional<double> crossing(const Vec3& origin, const Vec3& direction, const Vec3f& a,
                               const Vec3f& b, const Vec3f& c);

/// The beam's element-by-element trial: accepted iff bits < p·2³² (p = 1 always).
struct AcceptThreshold {
  uint32_t below;
  bool always;
  bool accepts(uint32_t bits) const { return always || bits < below; }
};
/// The threshold for hit probability p.
constexpr AcceptThreshold accept_threshold(double p) {
  if (p >= 1) return {0xffffffffu, true};
  return {p > 0 ? uint32_t(p * 4294967296.0) : 0u, false};
}

/// The beam's key within an instance, so that copies of a primitive decide independently; that of
/// instance 0 is the beam's own.
constexpr uint64_t instance_key(uint64_t key, uint32_t instance) {
  return key ^ mix64(uint64_t(instance) * 0x9e3779b97f4a7c15ull);
}

/// Whether the beam of this key accepts what it met.
inline bool accepts(uint64_t key, const Intersection& met) {
  return accept_threshold(met.p).accepts(accept_bits(instance_key(key, met.instance), met.element));
}

/// The cell of a voxel model that holds a point (model frame).
std::array<int64_t, 3> voxel_of(const Vec3& point, double voxel_m);

/// Element `element` of the model as the ray (model frame) meets it within `limits`; none if not.
Intersection intersect(const elements::Model& model, uint32_t element, const Vec3& origin,
                       const Vec3& direction, const RangeLimits& limits);

/// Whether model and world coordinates differ by a translation alone.
bool is_translation(const elements::Instance& placed);

/// A ray in the frame of an instance's model; its ranges there are the world's over the scale.
Ray to_model(const elements::Instance& placed, const Ray& ray);

/// Element `element` of an instance of `model`, the ray in world coordinates. Ranges and σ are in
/// the world's metres; the hit probability is the model's own, however it is scaled.
Intersection intersect(const elements::Model& model, const elements::Instance& placed,
                       uint32_t instance, uint32_t element, const Ray& ray,
                       const RangeLimits& limits);

}  // namespace trace
}  // namespace underbrush
