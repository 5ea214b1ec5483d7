/// \file
/// This file defines the ray model in double precision: the meetings of a ray and elements. Every
/// faster path must give exactly the same answers.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "underbrush/core/ray.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/elements/scene.hpp"

namespace underbrush {
/// Ray tracing: it finds the elements that a beam meets and the one that stops it.
namespace trace {

/// The meeting of a ray and an element.
struct Intersection {
  /// Range of the closest approach in Mahalanobis distance, or of the intersection, m.
  double t_m = 0;
  double sigma_m = 0;  ///< σ of the range that is drawn on a hit, m.
  double delta2 = 0;   ///< Squared Mahalanobis distance at the closest approach; 0 for triangles.
  double p = 0;        ///< Probability that the ray ends here, given that it came so far.
  uint32_t element = kNone;  ///< Element number within its model; kNone if nothing is met.
  uint32_t instance = 0;  ///< Number of the instance in the scene; 0 where the world is one model.

  static constexpr uint32_t kNone = 0xffffffffu;
  bool none() const { return element == kNone; }
  /// Whether this meeting comes first on the ray. The order is by range, then by instance and
  /// element.
  bool before(const Intersection& other) const {
    if (t_m != other.t_m) return t_m < other.t_m;
    return instance != other.instance ? instance < other.instance : element < other.element;
  }
};

/// The part of a ray on which elements count: t in [min_m, max_m], m.
struct RangeLimits {
  double min_m = 0;
  double max_m = 120;
};

/// Computes the closest approach of a ray to a Gaussian, [deschaud12] eq. 1–3:
///   t = dᵀΣ⁻¹(μ−o) / dᵀΣ⁻¹d,   δ² = |o + t d − μ|²_Σ,   σ² = 1 / dᵀΣ⁻¹d
/// `origin` (o) and `mean` (μ) are in one frame (m), `direction` (d) is a unit vector, and
/// `covariance` (Σ) is positive definite, in the order xx xy xz yy yz zz (m²).
Intersection approach(const Vec3& origin, const Vec3& direction, const Vec3f& mean,
                      const std::array<float, 6>& covariance);

/// Computes the range at which a ray crosses a triangle (m), or nothing if it misses or runs in the
/// triangle's plane. Both sides count, and so does the border. The test is watertight (Woop,
/// Benthin & Wald 2013): each vertex has one place for all triangles that share it and the signs of
/// the edge tests are exact, so a mesh has no gap along its edges or at its vertices.
std::optional<double> crossing(const Vec3& origin, const Vec3& direction, const Vec3f& a,
                               const Vec3f& b, const Vec3f& c);

/// The threshold of an element's random trial. A beam ends at the element iff its random bits are
/// less than p·2³², or always if p = 1.
struct AcceptThreshold {
  uint32_t below;
  bool always;
  bool accepts(uint32_t bits) const { return always || bits < below; }
};
/// Computes the threshold for hit probability p.
constexpr AcceptThreshold accept_threshold(double p) {
  if (p >= 1) return {0xffffffffu, true};
  return {p > 0 ? uint32_t(p * 4294967296.0) : 0u, false};
}

/// Computes the key of a beam within an instance. It differs between instances, so that copies of a
/// primitive have independent trials. In instance 0 it is the beam's own key.
constexpr uint64_t instance_key(uint64_t key, uint32_t instance) {
  return key ^ mix64(uint64_t(instance) * 0x9e3779b97f4a7c15ull);
}

/// Computes the key of a beam within an object that moves, which is instance 0 of its own tracer.
/// The upper half is left alone where matter sways, because it is the time.
constexpr uint64_t object_key(uint64_t key, uint32_t instance, bool sways) {
  const uint64_t salt = instance_key(0, instance);
  return key ^ (sways ? uint64_t(uint32_t(salt)) : salt);
}

/// Factors by which `swaying_cell` mixes elements, cells and intervals.
inline constexpr uint32_t kPhaseFactor[2] = {0x85ebca77u, 0x9e3779b1u}, kTimeFactor = 0x27d4eb2fu;

/// The time in ticks, of which 2¹⁶ are an interval of so many seconds, modulo 2³².
inline uint32_t ticks_of(double time_s, double interval_s) {
  return uint32_t(int64_t(std::floor(time_s / interval_s * 65536)));
}

/// Computes the cell whose matter stands in `cell` at a time. Once in every interval of 2¹⁶ ticks
/// other matter takes its place, in each cell at a time of its own. The matter at two times Δ
/// intervals apart is therefore the same with the probability max(0, 1 − Δ).
constexpr uint32_t swaying_cell(uint32_t cell, uint32_t element, uint32_t ticks) {
  const uint32_t phase = ((cell ^ element * kPhaseFactor[0]) * kPhaseFactor[1]) >> 16;
  return cell + kTimeFactor * ((ticks + phase) >> 16);
}

/// Whether a beam of this key ends at the element that it met. `cell` is that of `grain_cell`, or 0
/// where every beam draws anew.
inline bool accepts(uint64_t key, const Intersection& met, uint32_t cell = 0) {
  return accept_threshold(met.p).accepts(
      accept_bits(instance_key(key, met.instance) ^ cell, met.element));
}

/// Factors by which the numbers of a cell along x, y and z are mixed to 32 bits.
inline constexpr uint32_t kCellFactor[3] = {0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du};
/// Offset of the cells, in cells, so that a plane through the origin is not a border of cells.
inline constexpr double kCellOffset[3] = {0.3719, 0.6127, 0.4301};

/// Computes the cell of a voxel model that holds a point (model frame, m).
std::array<int64_t, 3> voxel_of(const Vec3& point, double voxel_m);

/// Computes the meeting of a ray (model frame) and an element of the model within `limits`. The
/// result is none() if there is none. This function is the definition of the ray model.
Intersection intersect(const elements::Model& model, uint32_t element, const Vec3& origin,
                       const Vec3& direction, const RangeLimits& limits);

/// Whether an instance's model frame differs from the world's by a translation alone.
bool is_translation(const elements::Instance& placed);

/// Transforms a ray into the frame of an instance's model. Ranges there are those of the world
/// divided by the instance's scale.
Ray to_model(const elements::Instance& placed, const Ray& ray);

/// The grain of an instance: the cells of its model's frame in which rays meet its elements.
class Grain {
 public:
  Grain() = default;
  /// `model` is that of the instance `placed` and must outlive it; `placed` is copied.
  Grain(const elements::Model& model, const elements::Instance& placed);
  /// Computes the cell in which a ray (world frame) met an element: the numbers of the cell that
  /// holds the point at `met.t_m`, mixed to 32 bits.
  uint32_t cell(const Ray& ray, const Intersection& met) const {
    const Ray local = translation_
                          ? Ray{ray.origin - placed_.world_from_model.translation, ray.direction}
                          : to_model(placed_, ray);
    const Vec3 at = local.origin + met.t_m / scale_ * local.direction;
    const double cells_per_m = 1 / side_m(met.element);
    uint32_t cell = 0;
    for (int k = 0; k < 3; ++k) {
      const double x = at[k] * cells_per_m + kCellOffset[k];
      int64_t number = int64_t(x);
      number -= double(number) > x;
      cell += kCellFactor[k] * uint32_t(number);
    }
    return cell;
  }

 private:
  double side_m(uint32_t element) const {
    if (element < first_ellipsoid_) return model_->grain.mesh_m;
    const elements::Grain& grain = model_->grain;
    return grain.classes.empty() ? grain.ellipsoid_m
                                 : grain.side_at(grain.place_of(
                                       model_->ellipsoids[model_->place(element).index].label));
  }

  const elements::Model* model_ = nullptr;
  elements::Instance placed_;
  double scale_ = 1;
  uint32_t first_ellipsoid_ = 0;
  bool translation_ = true;
};

/// Computes the meeting of a ray (world frame) and an element of an instance of `model` within
/// `limits`. Ranges and σ are in the world's metres. The hit probability is the unscaled model's.
Intersection intersect(const elements::Model& model, const elements::Instance& placed,
                       uint32_t instance, uint32_t element, const Ray& ray,
                       const RangeLimits& limits);

}  // namespace trace
}  // namespace underbrush
