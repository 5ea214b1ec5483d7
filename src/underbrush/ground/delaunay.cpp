#include "underbrush/ground/delaunay.hpp"

#include <cstdio>
#include <memory>
#include <stdexcept>

#include "underbrush/core/check.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace underbrush::ground {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether the points span no area.
bool on_a_line(std::span<const Eigen::Vector2d> points) {
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) {
    if ((p - points[0]).squaredNorm() > along.squaredNorm()) along = p - points[0];
  }
  for (const Eigen::Vector2d& p : points) {
    if (std::abs(cross(along, p - points[0])) > 1e-12 * along.squaredNorm()) return false;
  }
  return true;
}

/// Frees Qhull's memory on every way out.
struct Qhull {
  qhT state;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> sink{std::fopen("/dev/null", "w"), std::fclose};

  Qhull() { qh_zero(&state, sink.get()); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    qh_freeqhull(&state, !qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&state, &current, &total);
  }
};

}  // namespace

std::vector<std::array<uint32_t, 3>> delaunay(std::span<const Eigen::Vector2d> points) {
  for (const Eigen::Vector2d& p : points) {
    require(p.allFinite(), "Delaunay triangulation: a point is not finite");
  }
  if (points.size() < 3 || on_a_line(points)) return {};
  std::vector<coordT> xy;
  xy.reserve(2 * points.size());
  for (const Eigen::Vector2d& p : points) {
    xy.push_back(p.x() - points[0].x());
    xy.push_back(p.y() - points[0].y());
  }
  Qhull qhull;
  qhT* qh = &qhull.state;
  char command[] = "qhull d Qt Qbb Qc Qz";
  // Qhull wants both streams; what it says of a failure is its exit code.
  if (qh_new_qhull(qh, 2, int(points.size()), xy.data(), False, command, qhull.sink.get(),
                   qhull.sink.get())) {
    throw std::runtime_error("Delaunay triangulation: Qhull failed");
  }
  std::vector<std::array<uint32_t, 3>> triangles;
  triangles.reserve(2 * points.size());
  facetT* facet;
  FORALLfacets {
    if (facet->upperdelaunay) continue;
    std::array<uint32_t, 3> t{};
    size_t n = 0;
    vertexT *vertex, **vertexp;
    FOREACHvertex_(facet->vertices) {
      if (n < 3) t[n] = uint32_t(qh_pointid(qh, vertex->point));
      ++n;
    }
    // `Qz` adds a point at infinity, numbered after the others.
    if (n != 3 || t[0] >= points.size() || t[1] >= points.size() || t[2] >= points.size()) continue;
    const double area = cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    if (area == 0) continue;
    if (area < 0) std::swap(t[1], t[2]);
    triangles.push_back(t);
  }
  return triangles;
}

}  // namespace underbrush::ground
