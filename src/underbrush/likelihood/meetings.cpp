#include "underbrush/likelihood/meetings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace underbrush::likelihood {
namespace {

float tilt_of(const elements::Model& model, const trace::Intersection& m, const Vec3& direction) {
  const elements::ElementPlace at = model.place(m.element);
  const elements::TriangleMesh& mesh = model.mesh(at.kind);
  const auto& corner = mesh.triangles[at.index];
  const Vec3 a = mesh.vertices[corner[0]].cast<double>(),
             b = mesh.vertices[corner[1]].cast<double>(),
             c = mesh.vertices[corner[2]].cast<double>();
  const Vec3 normal = (b - a).cross(c - a);
  const double along = normal.dot(direction), square = normal.squaredNorm();
  return float(square / std::max(along * along, 1e-4 * square));
}

/// Lists what rays may meet: triangles that they do meet up to their reach, and then ellipsoids
/// that may give credit for the outcome of a beam.
void list_meetings(const trace::World& world, const trace::RangeLimits& limits,
                   std::span<const Ray> rays, std::span<const double> reach, BeamBlock& out) {
  const elements::Model& model = world.model();
  const size_t triangles = model.triangle_count();
  const float farthest = 1.0001f * kFarthestMisfit / float(model.tau);  // a bound, times τσ
  uint32_t* const first = out.first.data() + 1;
  uint32_t* const first_triangle = out.first_triangle.data() + 1;
  const auto [pairs, bounds] = world.candidates(rays, limits, reach);
  std::vector<trace::Candidate> crossing, near;
  for (size_t k = 0; k < pairs.size(); ++k) {
    const trace::Candidate& c = pairs[k];
    const bool is_triangle = c.element < triangles;
    const float least = bounds[k].least_t_m - farthest * bounds[k].reach_m;
    if (!is_triangle && least > out.beams[c.ray].range_m) continue;
    (is_triangle ? crossing : near).push_back(c);
    ++first[c.ray];
  }
  std::vector<trace::Intersection> met(crossing.size());
  world.intersections(rays, limits, crossing, met);
  for (size_t k = 0; k < met.size(); ++k) {
    const uint32_t ray = crossing[k].ray;
    if (met[k].t_m <= reach[ray] && !met[k].none()) {
      ++first_triangle[ray];
    } else {
      --first[ray];
      met[k].element = trace::Intersection::kNone;
    }
  }
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  std::partial_sum(out.first_triangle.begin(), out.first_triangle.end(),
                   out.first_triangle.begin());
  out.met.resize(out.first.back());
  out.on_triangle.resize(out.first_triangle.back());
  std::vector<uint32_t> next = out.first, next_triangle = out.first_triangle;
  for (size_t k = 0; k < met.size(); ++k) {
    if (met[k].none()) continue;
    const uint32_t ray = crossing[k].ray;
    out.met[next[ray]++] = met[k].element;
    out.on_triangle[next_triangle[ray]++] = {float(met[k].t_m),
                                             tilt_of(model, met[k], rays[ray].direction)};
  }
  for (const trace::Candidate& c : near) out.met[next[c.ray]++] = c.element;
}

}  // namespace

void find_meetings(const trace::World& world, const LogInfo& info, BeamBlock& block) {
  const elements::Model& model = world.model();
  const trace::RangeLimits limits{info.min_range_m, std::min(info.max_range_m, model.max_range_m)};
  block.first.assign(block.beams.size() + 1, 0);
  block.first_triangle.assign(block.beams.size() + 1, 0);
  std::vector<Ray> rays;
  std::vector<double> reach_m;
  rays.reserve(block.beams.size());
  reach_m.reserve(block.beams.size());
  for (const ListedBeam& b : block.beams) {
    const Vec3f origin(b.origin[0], b.origin[1], b.origin[2]);
    const Vec3f direction(b.direction[0], b.direction[1], b.direction[2]);
    rays.push_back({model.origin + origin.cast<double>(), direction.cast<double>()});
    reach_m.push_back(b.reach_m);
  }
  list_meetings(world, limits, rays, reach_m, block);
}

}  // namespace underbrush::likelihood
