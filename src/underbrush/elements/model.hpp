/// \file
/// The world model that a fitter learns and the simulator traces: scene elements e = (ρ, ω) with
/// geometry ρ and sensor parameters ω ([tallavajhula18] §III).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/channel_offsets.hpp"
#include "underbrush/core/leaf_angle_distribution.hpp"
#include "underbrush/core/pose.hpp"
#include "underbrush/elements/grain.hpp"
#include "underbrush/elements/keyframes.hpp"
#include "underbrush/elements/light.hpp"
#include "underbrush/elements/observed_space.hpp"

namespace underbrush {
/// Scene elements and the model that holds them.
namespace elements {

/// Counts of the beams that met an element and ended at it (hits) or went on (misses), and the hit
/// probability p learnt from them. The permeability of [deschaud12] §III is 1 − p.
struct HitCount {
  float p = 1;
  uint32_t hits = 0;
  uint32_t misses = 0;
};

/// Triangles, each with a hit probability and a roughness, and one range noise for all of them.
struct TriangleMesh {
  std::vector<Vec3f> vertices;                     ///< m, relative to the model's origin.
  std::vector<std::array<uint32_t, 3>> triangles;  ///< Indices into `vertices`.
  std::vector<HitCount> hit;                       ///< The hits of each triangle.
  std::vector<Reflectance> light;  ///< The light of each triangle; empty if unknown.
  double range_sigma_m = 0;        ///< m; standard deviation σ of the range about the surface.
  /// h (m): standard deviation, along the normal, of the surface about the mesh. A beam at the
  /// angle of incidence θ has the range variance σ² = range_sigma_m² + (h / max(|cos θ|, 0.01))².
  double roughness_m = 0;
  std::vector<float> roughness;  ///< h of each triangle, m; empty where all have `roughness_m`.

  size_t size() const { return triangles.size(); }
  /// h of a triangle, m.
  double roughness_at(size_t triangle) const {
    return roughness.empty() ? roughness_m : double(roughness[triangle]);
  }
};

/// A permeable Gaussian volume ω = (μ, Σ, p_hit).
struct Ellipsoid {
  Vec3f mean = Vec3f::Zero();                         ///< μ, m, relative to the model's origin.
  std::array<float, 6> covariance{1, 0, 0, 1, 0, 1};  ///< Σ, m²: xx xy xz yy yz zz.
  HitCount hit;
  /// Class of the points that it was fitted to: a `Class`, or one of `Model::class_names`.
  uint32_t label = 0;
  /// κ (1/m). If it is positive, the hit probability depends on how much of the volume a beam
  /// crosses, p(δ) = 1 − exp(−κ √(2π) σ e^{−δ²/2}) with the standard deviation σ along the beam,
  /// and `hit.p` is not used.
  float density_per_m = 0;
  Reflectance light;

  Mat3 covariance_matrix() const;
  void set_covariance(const Mat3& sigma);
};

/// Kinds of scene elements, in the order in which a model numbers its elements.
enum class Kind : uint8_t { kGround, kSurface, kEllipsoid };

/// The place of an element in a model: the array of its kind and its index there.
struct ElementPlace {
  Kind kind = Kind::kGround;
  uint32_t index = 0;
};

/// The whole model of which a model is a part. Elements keep their numbers in a part, so that
/// random draws are the same as in the whole model.
struct PartOf {
  std::array<uint32_t, 3> counts{};  ///< Numbers of elements of the whole, by `Kind`.
  /// The place of each element of the part in its array of the whole, ascending, by `Kind`.
  std::array<std::vector<uint32_t>, 3> numbers;
  /// The whole's `mean_reflectance`, by `Kind`.
  std::array<MeanReflectance, 3> reflectance;
  /// The ground of the whole model, as vertices alone; null where no space is unknown.
  std::shared_ptr<const TriangleMesh> ground;

  /// The number of the whole's first element of a kind.
  uint32_t first(Kind kind) const {
    return kind == Kind::kGround ? 0 : kind == Kind::kSurface ? counts[0] : counts[0] + counts[1];
  }
  /// The place in the part of the element of this number, which the part must have.
  ElementPlace place(uint32_t element) const;
};

/// A learnt world. Elements are numbered: ground triangles, then surface triangles, then
/// ellipsoids.
struct Model {
  Vec3 origin = Vec3::Zero();  ///< m, world; all coordinates of the model are relative to it.
  TriangleMesh ground;
  TriangleMesh surface;  ///< Opaque or permeable triangles that are not ground.
  std::vector<Ellipsoid> ellipsoids;
  /// Names of the classes of ellipsoids besides `kClassNames`, whose numbers follow those.
  std::vector<std::string> class_names;
  double tau = 3.5;  ///< A beam meets an ellipsoid if it comes within this Mahalanobis distance.
  /// Side (m) of the cells of a voxel model ([deschaud12] §III.C.1); 0 for other models. In a voxel
  /// model an ellipsoid counts only where the beam's closest approach lies in the cell that holds
  /// its mean; the cells form a grid through the model's origin.
  double voxel_m = 0;
  Grain grain;
  Light light;  ///< The response of the log's sensor; unknown where it had no intensities.
  /// m; the part of every element's σ that is noise of the sensor. Each beam draws this noise anew,
  /// also where matter is drawn once.
  double range_noise_m = 0;
  /// The inclinations of the leaves of ellipsoids with a density.
  LeafAngleDistribution leaf_angles;
  /// s; the correlation time after which the random outcome at an ellipsoid is replaced by another
  /// one, where matter is drawn once. Matter stands still if it is 0.
  double sway_s = 0;
  /// m; the largest range of the sensor of the log that the model was fitted to, or of that log's
  /// format (`RangeCut::reach_m`). Infinite if unknown.
  double max_range_m = std::numeric_limits<double>::infinity();
  /// The sensor that recorded the log that the model was fitted to, as in `LogInfo`; empty if
  /// unknown. Its footprint is in the extents of the elements and in their hit probabilities.
  std::string sensor, sensor_file;
  /// The errors of that sensor's ranges, from which the geometry is free; empty where none are
  /// known.
  ChannelOffsets channels;
  /// Scans of the log, stored as range images; null if the model has no keyframes.
  std::shared_ptr<const Keyframes> keyframes;
  /// The space that the log's beams crossed; null where unknown space counts as empty.
  std::shared_ptr<const ObservedSpace> observed;
  /// Whether every echo of the log counted as a beam, so that hit probabilities are shares of the
  /// light and do not contain the footprint.
  bool all_echoes = false;
  /// The whole model of which this is a part; null if this is a whole model.
  std::shared_ptr<const PartOf> part_of;
  std::string fitter;      ///< Name of the fitter that made the model.
  std::string provenance;  ///< JSON object: program version, command, seed, hashes of the inputs.

  size_t size() const { return ground.size() + surface.size() + ellipsoids.size(); }
  size_t triangle_count() const { return ground.size() + surface.size(); }
  /// The number of elements of a kind; in a part, of the whole.
  size_t whole_count(Kind kind) const;
  /// The number of the first ellipsoid.
  size_t first_ellipsoid() const {
    return part_of ? part_of->first(Kind::kEllipsoid) : triangle_count();
  }
  /// The place of the k-th element of the model's arrays, which come one after another.
  ElementPlace place_at(size_t k) const {
    if (k < ground.size()) return {Kind::kGround, uint32_t(k)};
    if (k < triangle_count()) return {Kind::kSurface, uint32_t(k - ground.size())};
    return {Kind::kEllipsoid, uint32_t(k - triangle_count())};
  }
  /// The number of the k-th element of the model's arrays: k, or in a part that of the whole.
  uint32_t number_at(size_t k) const {
    if (!part_of) return uint32_t(k);
    const ElementPlace at = place_at(k);
    return part_of->first(at.kind) + part_of->numbers[size_t(at.kind)][at.index];
  }
  /// The place of the element of this number; numbers are not checked.
  ElementPlace place(size_t element) const {
    return part_of ? part_of->place(uint32_t(element)) : place_at(element);
  }
  Kind kind(size_t element) const { return place(element).kind; }
  /// The name of a class of ellipsoids, or its number as text where it has none.
  std::string class_name(uint32_t label) const;
  /// The number of the class of that name; empty if there is none.
  std::optional<uint32_t> class_number(std::string_view name) const;
  /// The mesh of `Kind::kGround` or `Kind::kSurface`.
  const TriangleMesh& mesh(Kind kind) const { return kind == Kind::kGround ? ground : surface; }
  /// The box of all elements that rays can meet, m, relative to the origin; empty without elements.
  Eigen::AlignedBox3d box() const;
  HitCount& hit(size_t element);
  const HitCount& hit(size_t element) const;
  /// The offsets in the ranges of a log: `channels` where it is of the same sensor, else none.
  ChannelOffsets channels_of(const LogInfo& log) const;
  /// The range (m) beyond which beams of that log are misses: `max_range_m` where it is of the same
  /// sensor, or both sensors are unknown, else infinite.
  double reach_of(const LogInfo& log) const;
  /// Returns a model without elements that is otherwise the same; it has no provenance and no
  /// keyframes, and it is no part.
  Model like() const;
  /// Throws `std::invalid_argument` where a value is not finite, an index is out of range, a
  /// probability lies outside [0, 1] or a covariance is not positive definite.
  void check() const;
};

/// Returns the covariance with its eigenvalues raised to at least `floor_m`². The floor is the
/// noise of the sensor, below which no extent can be measured; flat or thin elements and those of
/// few points reach it. The result is symmetric if `sigma` is.
Mat3 floored_covariance(const Mat3& sigma, double floor_m);
/// Returns the covariance with its eigenvalues raised to at least 1 in the frame in which `least`,
/// which is positive definite, is the unit sphere. So no variance is below that of `least`.
Mat3 floored_covariance(const Mat3& sigma, const Mat3& least);

}  // namespace elements
}  // namespace underbrush
