#include "underbrush/simulate/sub_ray_bundle.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/core/clones.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::simulate {
namespace {

constexpr size_t kNumbers = 6;              // numbers of a ray
constexpr size_t kTogether = 2 * kNumbers;  // fills whole registers

static_assert(sizeof(Ray) == kNumbers * sizeof(double));

/// The origin and direction of a beam's axis and the directions across it, repeated to fill
/// registers.
struct Frame {
  explicit Frame(const sensor::BeamAxes& axes) {
    for (size_t c = 0; c < 3; ++c) {
      const auto e = Eigen::Index(c);
      start[c] = start[c + 6] = axes.axis.origin[e];
      start[c + 3] = start[c + 9] = axes.axis.direction[e];
      right[c] = right[c + 3] = right[c + 6] = right[c + 9] = axes.right[e];
      up[c] = up[c + 3] = up[c + 6] = up[c + 9] = axes.up[e];
    }
  }
  double start[kTogether], right[kTogether], up[kTogether];
};

UNDERBRUSH_CLONES void place(size_t n, const double* __restrict along,
                             const double* __restrict right, const double* __restrict up,
                             const Frame& f, double* __restrict out) {
  size_t k = 0;
  for (; k + kTogether <= n; k += kTogether) {
    for (size_t j = 0; j < kTogether; ++j) {
      out[k + j] = along[k + j] * f.start[j] + (right[k + j] * f.right[j] + up[k + j] * f.up[j]);
    }
  }
  for (size_t j = 0; k < n; ++k, ++j) {
    out[k] = along[k] * f.start[j] + (right[k] * f.right[j] + up[k] * f.up[j]);
  }
}

UNDERBRUSH_CLONES void mix_keys(uint64_t key, size_t n, uint64_t* keys) {
  for (size_t k = 0; k < n; ++k) keys[k] = mix64(key + 0x9e3779b97f4a7c15ull * k);
}

}  // namespace

SubRayBundle::SubRayBundle(const sensor::BeamShape& shape, std::span<const sensor::SubRay> places) {
  shape.check();
  require(!places.empty(), "echoes: at least one sub-ray is needed");
  const sensor::RayMaker maker(shape);
  const sensor::BeamAxes axes{{Vec3::Zero(), Vec3::UnitX()}, Vec3::UnitY(), Vec3::UnitZ(), {}};
  for (const sensor::SubRay& place : places) {
    const Ray ray = maker.ray(axes, double(place.u), double(place.v));
    for (const Vec3& part : {Vec3(1, ray.origin.y(), ray.origin.z()), ray.direction}) {
      along_.insert(along_.end(), 3, part.x());
      right_.insert(right_.end(), 3, part.y());
      up_.insert(up_.end(), 3, part.z());
    }
    weight_.push_back(place.weight);
  }
}

void SubRayBundle::spread(const sensor::BeamAxes& axes, Ray* rays) const {
  place(along_.size(), along_.data(), right_.data(), up_.data(), Frame(axes),
        reinterpret_cast<double*>(rays));
}

void SubRayBundle::keys(uint64_t beam_key, uint64_t* keys) const {
  mix_keys(beam_key, size(), keys);
  keys[0] = beam_key;
}

}  // namespace underbrush::simulate
