#include "underbrush/fit/meetings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "underbrush/core/parallel.hpp"

namespace underbrush::fit {
namespace {

constexpr size_t kPiece = 1024;  // beams that are searched together

/// The meetings of a piece of a block.
struct Piece {
  std::vector<uint32_t> met;
  std::vector<TriangleMeeting> on_triangle;
};

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

/// Rays of a piece of a block, and where the numbers of their meetings go.
struct PieceRays {
  std::vector<Ray> rays;
  std::vector<double> reach_m;
  std::span<const ListedBeam> beams;
  std::span<uint32_t> first, first_triangle;
};

/// Lists what rays may meet: triangles that they do meet up to their reach, and then ellipsoids
/// that may give credit for the outcome of a beam.
void list_meetings(const trace::World& world, const trace::RangeLimits& limits, const PieceRays& of,
                   Piece& out) {
  const elements::Model& model = world.model();
  const size_t triangles = model.triangle_count();
  const float farthest = 1.0001f * kFarthestMisfit / float(model.tau);  // a bound, times τσ
  const auto& [rays, reach, beams, first, first_triangle] = of;
  const auto [pairs, bounds] = world.candidates(rays, limits, reach);
  std::vector<trace::Candidate> crossing, near;
  for (size_t k = 0; k < pairs.size(); ++k) {
    const trace::Candidate& c = pairs[k];
    const bool is_triangle = c.element < triangles;
    const float least = bounds[k].least_t_m - farthest * bounds[k].reach_m;
    if (!is_triangle && least > beams[c.ray].range_m) continue;
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
  std::vector<uint32_t> next(rays.size()), next_triangle(rays.size());
  std::exclusive_scan(first.begin(), first.end(), next.begin(), 0u);
  std::exclusive_scan(first_triangle.begin(), first_triangle.end(), next_triangle.begin(), 0u);
  out.met.resize(next.back() + first.back());
  out.on_triangle.resize(next_triangle.back() + first_triangle.back());
  for (size_t k = 0; k < met.size(); ++k) {
    if (met[k].none()) continue;
    const uint32_t ray = crossing[k].ray;
    out.met[next[ray]++] = met[k].element;
    out.on_triangle[next_triangle[ray]++] = {float(met[k].t_m),
                                             tilt_of(model, met[k], rays[ray].direction)};
  }
  for (const trace::Candidate& c : near) out.met[next[c.ray]++] = c.element;
}

/// Joins the meetings of pieces of a block, whose `first` and `first_triangle` have the numbers of
/// each beam.
void join(std::vector<Piece>& pieces, BeamBlock& block) {
  const size_t n = block.beams.size();
  for (size_t i = 0; i < n; ++i) {
    block.first[i + 1] += block.first[i];
    block.first_triangle[i + 1] += block.first_triangle[i];
  }
  block.met.resize(block.first[n]);
  block.on_triangle.resize(block.first_triangle[n]);
  parallel_for(n, kPiece, [&](size_t begin, size_t) {
    const Piece from = std::exchange(pieces[begin / kPiece], {});
    std::copy(from.met.begin(), from.met.end(), block.met.begin() + block.first[begin]);
    std::copy(from.on_triangle.begin(), from.on_triangle.end(),
              block.on_triangle.begin() + block.first_triangle[begin]);
  });
}

}  // namespace

MeetingsByElement by_element(const BeamBlock& block, size_t elements) {
  MeetingsByElement out;
  std::vector<uint32_t> at(elements);
  for (size_t b = 0; b < block.beams.size(); ++b) {
    for (size_t s = block.first[b]; s < block.first[b + 1]; ++s) ++at[block.met[s]];
  }
  uint32_t sum = 0;
  for (size_t e = 0; e < elements; ++e) {
    const uint32_t count = std::exchange(at[e], sum);
    if (count) out.elements.push_back({uint32_t(e), sum});
    sum += count;
  }
  out.elements.push_back({uint32_t(elements), sum});
  out.met.resize(sum);
  for (size_t b = 0; b < block.beams.size(); ++b) {
    for (size_t s = block.first[b]; s < block.first[b + 1]; ++s) {
      out.met[at[block.met[s]]++] = {uint32_t(b), uint32_t(s)};
    }
  }
  return out;
}

void find_meetings(const trace::World& world, const LogInfo& info, BeamBlock& block) {
  const elements::Model& model = world.model();
  const trace::RangeLimits limits{info.min_range_m, std::min(info.max_range_m, model.max_range_m)};
  const size_t n = block.beams.size();
  block.first.assign(n + 1, 0);
  block.first_triangle.assign(n + 1, 0);
  std::vector<Piece> found((n + kPiece - 1) / kPiece);
  parallel_for(n, kPiece, [&](size_t begin, size_t end) {
    const size_t count = end - begin;
    PieceRays of{{},
                 {},
                 std::span(block.beams).subspan(begin, count),
                 std::span(block.first).subspan(begin + 1, count),
                 std::span(block.first_triangle).subspan(begin + 1, count)};
    for (const ListedBeam& b : of.beams) {
      const Vec3f origin(b.origin[0], b.origin[1], b.origin[2]);
      const Vec3f direction(b.direction[0], b.direction[1], b.direction[2]);
      of.rays.push_back({model.origin + origin.cast<double>(), direction.cast<double>()});
      of.reach_m.push_back(b.reach_m);
    }
    list_meetings(world, limits, of, found[begin / kPiece]);
  });
  join(found, block);
}

}  // namespace underbrush::fit
