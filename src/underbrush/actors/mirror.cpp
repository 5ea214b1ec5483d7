#include "underbrush/actors/mirror.hpp"

#include <vector>

#include "underbrush/trace/world.hpp"

namespace underbrush::actors {
namespace {

constexpr uint32_t kTimesFewer = 10;
constexpr double kNear2 = 1;  // squared Mahalanobis distance of a beam that meets a place

elements::Ellipsoid mirrored(elements::Ellipsoid e) {
  e.mean.y() *= -1;
  e.covariance[1] *= -1;  // xy
  e.covariance[4] *= -1;  // yz
  return e;
}

/// Counts, for each ellipsoid, the beams that met its place before their return or ended there.
std::vector<uint32_t> meetings(const BeamLog& beams, const elements::Model& model) {
  const trace::World world(model);
  std::vector<uint32_t> out(model.ellipsoids.size());
  std::vector<trace::Intersection> met;
  for (size_t i = 0; i < beams.size(); ++i) {
    const double end = beams.is_hit(i) ? double(beams.range_m[i]) : beams.info.max_range_m;
    met.clear();
    world.all_intersections(beams.ray(i), {0, beams.info.max_range_m}, end, met);
    for (const trace::Intersection& m : met) {
      if (m.delta2 <= kNear2 && m.t_m - m.sigma_m <= end) ++out[m.element];
    }
  }
  return out;
}

}  // namespace

size_t complete_by_symmetry(const BeamLog& beams, elements::Model& model) {
  elements::Model own = model.like(), images = model.like();
  own.ellipsoids = model.ellipsoids;
  for (const elements::Ellipsoid& e : model.ellipsoids) images.ellipsoids.push_back(mirrored(e));
  const std::vector<uint32_t> of_own = meetings(beams, own), of_images = meetings(beams, images);
  for (size_t k = 0; k < images.ellipsoids.size(); ++k) {
    if (kTimesFewer * of_images[k] < of_own[k]) model.ellipsoids.push_back(images.ellipsoids[k]);
  }
  return model.ellipsoids.size() - own.ellipsoids.size();
}

}  // namespace underbrush::actors
