#include "studies/planar_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"
#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/parallel.hpp"
#include "underbrush/metrics/normals.hpp"

namespace underbrush::studies {
namespace {

/// The neighbours of all points within the gap, `k` entries for each point; unused entries hold the
/// point's own index.
struct Neighbours {
  size_t k;
  std::vector<uint32_t> index;
  std::span<const uint32_t> of(size_t point) const { return {index.data() + point * k, k}; }
};

Neighbours neighbours_of(std::span<const Vec3f> cloud, const PatchOptions& options) {
  Neighbours out{std::min(size_t(options.neighbours), cloud.size()), {}};
  out.index.resize(cloud.size() * out.k);
  const CloudTree tree(cloud);
  const auto gap2 = float(options.most_gap_m * options.most_gap_m);
  parallel_for(cloud.size(), 2048, [&](size_t begin, size_t end) {
    std::vector<float> squared(out.k);
    for (size_t i = begin; i < end; ++i) {
      uint32_t* own = out.index.data() + i * out.k;
      tree.nearest(cloud[i].data(), out.k, own, squared.data());
      for (size_t j = 0; j < out.k; ++j) {
        if (squared[j] > gap2) own[j] = uint32_t(i);
      }
    }
  });
  return out;
}

/// Returns the points in order of how much the normals around them differ, least first.
std::vector<uint32_t> seeds_in_order(const std::vector<Vec3f>& normal, const Neighbours& around) {
  std::vector<float> bend(normal.size());
  for (size_t i = 0; i < normal.size(); ++i) {
    for (const uint32_t j : around.of(i)) bend[i] += 1 - std::abs(normal[i].dot(normal[j]));
    const auto alone = std::count(around.of(i).begin(), around.of(i).end(), uint32_t(i));
    bend[i] += float(alone - 1);  // Neighbours that are too far away count as different.
  }
  std::vector<uint32_t> order(normal.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return bend[a] < bend[b]; });
  return order;
}

/// Returns the convex hull of points on the plane.
std::vector<Vec3> outline_of(const Plane& plane, const std::vector<Vec3>& points) {
  using Point2 = Eigen::Vector2d;
  std::vector<Point2> flat;
  flat.reserve(points.size());
  for (const Vec3& p : points) {
    flat.emplace_back(plane.u.dot(p - plane.centre), plane.v.dot(p - plane.centre));
  }
  std::sort(flat.begin(), flat.end(), [](const Point2& a, const Point2& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Point2> hull;
  const auto add = [&](const Point2& p, size_t least) {
    const auto turns_right = [&] {
      const Point2 a = hull.back() - hull[hull.size() - 2], b = p - hull.back();
      return a.x() * b.y() - a.y() * b.x() <= 0;
    };
    while (hull.size() > least && turns_right()) hull.pop_back();
    hull.push_back(p);
  };
  for (const Point2& p : flat) add(p, 1);
  const size_t lower = hull.size();
  for (size_t i = flat.size() - 1; i-- > 0;) add(flat[i], lower);
  hull.pop_back();
  std::vector<Vec3> out;
  out.reserve(hull.size());
  for (const Point2& p : hull) out.push_back(plane.centre + p.x() * plane.u + p.y() * plane.v);
  return out;
}

std::vector<Vec3> chosen(std::span<const Vec3f> cloud, const std::vector<uint32_t>& index) {
  std::vector<Vec3> out;
  out.reserve(index.size());
  for (const uint32_t i : index) out.push_back(cloud[i].cast<double>());
  return out;
}

/// Grows one patch from `seed` and marks its points as taken.
PlanarPatch grow(std::span<const Vec3f> cloud, const std::vector<Vec3f>& normal,
                 const Neighbours& around, const PatchOptions& options, uint32_t seed,
                 std::vector<bool>& taken) {
  PlanarPatch patch;
  patch.plane.normal = normal[seed].cast<double>();
  patch.plane.offset_m = patch.plane.normal.dot(cloud[seed].cast<double>());
  patch.points = {seed};
  taken[seed] = true;
  size_t fit_at = 16;
  const double least_cos = std::cos(options.most_angle_rad);
  for (size_t k = 0; k < patch.points.size(); ++k) {
    if (patch.points.size() >= fit_at) {
      patch.plane = fit_plane(chosen(cloud, patch.points));
      fit_at *= 2;
    }
    for (const uint32_t j : around.of(patch.points[k])) {
      if (taken[j]) continue;
      if (std::abs(patch.plane.distance(cloud[j].cast<double>())) > options.most_distance_m)
        continue;
      if (std::abs(patch.plane.normal.dot(normal[j].cast<double>())) < least_cos) continue;
      taken[j] = true;
      patch.points.push_back(j);
    }
  }
  return patch;
}

}  // namespace

std::vector<PlanarPatch> planar_patches(std::span<const Vec3f> cloud, const PatchOptions& options) {
  require(options.neighbours >= 3 && options.least_points > 3, "planar patches: too few points");
  std::vector<PlanarPatch> out;
  if (cloud.size() < options.least_points) return out;
  const std::vector<Vec3f> normal = metrics::normals(cloud, size_t(options.neighbours));
  const Neighbours around = neighbours_of(cloud, options);
  std::vector<bool> taken(cloud.size());
  for (const uint32_t seed : seeds_in_order(normal, around)) {
    if (taken[seed]) continue;
    PlanarPatch patch = grow(cloud, normal, around, options, seed, taken);
    if (patch.points.size() < options.least_points) continue;
    std::sort(patch.points.begin(), patch.points.end());
    out.push_back(std::move(patch));
  }
  std::stable_sort(out.begin(), out.end(), [](const PlanarPatch& a, const PlanarPatch& b) {
    return a.points.size() > b.points.size();
  });
  if (out.size() > options.most_patches) out.resize(options.most_patches);
  for (PlanarPatch& patch : out) {
    const std::vector<Vec3> points = chosen(cloud, patch.points);
    patch.plane = fit_plane(points);
    patch.outline = outline_of(patch.plane, points);
  }
  return out;
}

}  // namespace underbrush::studies
