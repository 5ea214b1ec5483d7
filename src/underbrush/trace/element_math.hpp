/// \file
/// The ray model in double precision: which elements a ray meets and where. This is the definition
/// that every faster path must reproduce exactly.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "underbrush/core/ray.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush {
/// Which elements a beam meets, and which one stops it.
namespace trace {

/// A ray meeting an element.
struct Met {
  double t_m = 0;      ///< Range of the closest Mahalanobis approach, or of the intersection.
  double sigma_m = 0;  ///< σ of the range drawn on a hit.
  double delta2 = 0;   ///< Squared Mahalanobis distance of the closest approach; 0 for triangles.
  uint32_t element = kNone;

  static constexpr uint32_t kNone = 0xffffffffu;
  bool none() const { return element == kNone; }
  /// The order of visiting: by range, ties by element.
  bool before(const Met& other) const {
    return t_m != other.t_m ? t_m < other.t_m : element < other.element;
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
Met approach(const Vec3& origin, const Vec3& direction, const Vec3f& mean,
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
};
/// The threshold for hit probability p.
constexpr AcceptThreshold accept_threshold(float p) {
  if (p >= 1) return {0xffffffffu, true};
  return {p > 0 ? uint32_t(double(p) * 4294967296.0) : 0u, false};
}

/// Element `element` of the model as the ray (model frame) meets it within `limits`; none if not.
Met meet(const elements::Model& model, uint32_t element, const Vec3& origin, const Vec3& direction,
         const RangeLimits& limits);

}  // namespace trace
}  // namespace underbrush
