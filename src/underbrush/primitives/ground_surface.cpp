#include "underbrush/primitives/ground_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "underbrush/core/check.hpp"

namespace underbrush::primitives {

GroundSurface::GroundSurface(const elements::Model& model) : model_(model) {
  const elements::TriangleMesh& mesh = model.ground;
  require(mesh.size() > 0, "the model has no ground");
  const Eigen::Vector2d origin = model.origin.head<2>();
  for (const Vec3f& v : mesh.vertices) bounds_.extend(origin + v.head<2>().cast<double>());
  const Eigen::Vector2d size = bounds_.sizes();
  // A cell holds about one triangle; long meshes are limited to 4096 cells along a side.
  cell_m_ = std::max(std::sqrt(size.x() * size.y() / double(mesh.size())), size.maxCoeff() / 4096);
  cell_m_ = std::max(cell_m_, 1e-3);
  columns_ = int(size.x() / cell_m_) + 1;
  rows_ = int(size.y() / cell_m_) + 1;
  const auto for_each_cell = [&](size_t t, const auto& f) {
    Eigen::AlignedBox2d box;
    for (const uint32_t k : mesh.triangles[t]) {
      box.extend(origin + mesh.vertices[k].head<2>().cast<double>());
    }
    const Eigen::Vector2d low = (box.min() - bounds_.min()) / cell_m_;
    const Eigen::Vector2d high = (box.max() - bounds_.min()) / cell_m_;
    for (int y = int(low.y()); y <= std::min(int(high.y()), rows_ - 1); ++y) {
      for (int x = int(low.x()); x <= std::min(int(high.x()), columns_ - 1); ++x) {
        f(size_t(y) * size_t(columns_) + size_t(x));
      }
    }
  };
  begin_.assign(size_t(columns_) * size_t(rows_) + 1, 0);
  for (size_t t = 0; t < mesh.size(); ++t) {
    for_each_cell(t, [&](size_t cell) { ++begin_[cell + 1]; });
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  triangle_.resize(begin_.back());
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t t = 0; t < mesh.size(); ++t) {
    for_each_cell(t, [&](size_t cell) { triangle_[next[cell]++] = uint32_t(t); });
  }
}

std::optional<double> GroundSurface::at(double x, double y) const {
  const Eigen::Vector2d p(x, y);
  if (!bounds_.contains(p)) return std::nullopt;
  const Eigen::Vector2d place = (p - bounds_.min()) / cell_m_;
  const size_t cell = size_t(std::min(int(place.y()), rows_ - 1)) * size_t(columns_) +
                      size_t(std::min(int(place.x()), columns_ - 1));
  const Eigen::Vector2d q = p - model_.origin.head<2>();
  std::optional<double> highest;
  for (uint32_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
    const auto& t = model_.ground.triangles[triangle_[k]];
    const Vec3 a = model_.ground.vertices[t[0]].cast<double>();
    const Vec3 b = model_.ground.vertices[t[1]].cast<double>();
    const Vec3 c = model_.ground.vertices[t[2]].cast<double>();
    const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
      return u.x() * v.y() - u.y() * v.x();
    };
    const Eigen::Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>(), aq = q - a.head<2>();
    const double area = cross(ab, ac);
    if (area == 0) continue;
    const double v = cross(aq, ac) / area, w = cross(ab, aq) / area;
    constexpr double kEdge = -1e-9;
    if (v < kEdge || w < kEdge || v + w > 1 - kEdge) continue;
    const double z = model_.origin.z() + a.z() + v * (b.z() - a.z()) + w * (c.z() - a.z());
    if (!highest || z > *highest) highest = z;
  }
  return highest;
}

}  // namespace underbrush::primitives
