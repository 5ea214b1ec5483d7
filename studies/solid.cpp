#include "studies/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"

namespace underbrush::studies {
namespace {

using Place = Eigen::Vector2d;

/// Returns twice the vector area (Newell), which is along the normal and as long as twice the area.
Vec3 twice_area(const std::vector<Vec3>& corners) {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < corners.size(); ++i) {
    sum += (corners[i] - corners[0]).cross(corners[(i + 1) % corners.size()] - corners[0]);
  }
  return sum;
}

double cross(const Place& a, const Place& b) { return a.x() * b.y() - a.y() * b.x(); }

bool in_triangle(const Place& p, const Place& a, const Place& b, const Place& c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

double distance_to_segment(const Place& p, const Place& a, const Place& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// Whether two edges that share no corner cross.
bool touches_itself(const std::vector<Place>& outline) {
  const size_t n = outline.size();
  const auto side = [&](size_t edge, const Place& p) {
    const Place& a = outline[edge];
    return cross(outline[(edge + 1) % n] - a, p - a);
  };
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (side(i, outline[j]) * side(i, outline[(j + 1) % n]) <= 0 &&
          side(j, outline[i]) * side(j, outline[i + 1]) <= 0) {
        return true;
      }
    }
  }
  return false;
}

/// Cuts ears off `outline` until a triangle is left; returns indices into it.
std::vector<std::array<size_t, 3>> ears(const std::vector<Place>& outline) {
  std::vector<size_t> left(outline.size());
  for (size_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<size_t, 3>> out;
  const auto is_ear = [&](size_t k) {
    const size_t n = left.size();
    const Place &a = outline[left[(k + n - 1) % n]], &b = outline[left[k]],
                &c = outline[left[(k + 1) % n]];
    if (cross(b - a, c - b) <= 0) return false;
    for (size_t j = 0; j < n; ++j) {
      if (j == k || j == (k + 1) % n || j == (k + n - 1) % n) continue;
      if (in_triangle(outline[left[j]], a, b, c)) return false;
    }
    return true;
  };
  while (left.size() > 3) {
    const size_t n = left.size();
    size_t k = 0;
    while (k < n && !is_ear(k)) ++k;
    if (k == n) k = 0;  // All corners lie on a line: this is an ear without area.
    out.push_back({left[(k + n - 1) % n], left[k], left[(k + 1) % n]});
    left.erase(left.begin() + std::ptrdiff_t(k));
  }
  out.push_back({left[0], left[1], left[2]});
  return out;
}

}  // namespace

std::vector<Vec3> Solid::corners(size_t face) const {
  std::vector<Vec3> out;
  for (const uint32_t i : faces.at(face)) out.push_back(vertices.at(i));
  return out;
}

Vec3 Solid::normal(size_t face) const { return twice_area(corners(face)).normalized(); }

void Solid::check() const {
  for (const Vec3& v : vertices) require(v.allFinite(), "solid: a corner that is not finite");
  for (size_t f = 0; f < faces.size(); ++f) {
    require(faces[f].size() >= 3, "solid: a face with fewer than three corners");
    for (const uint32_t i : faces[f]) {
      require(i < vertices.size(), "solid: a face with a corner that does not exist");
    }
    const std::vector<Vec3> c = corners(f);
    double size = 0;
    for (const Vec3& p : c) size = std::max(size, (p - c[0]).norm());
    const Vec3 area = twice_area(c);
    require(area.norm() > 1e-9 * size * size, "solid: a face without area");
    for (const Vec3& p : c) {
      require(std::abs(area.normalized().dot(p - c[0])) <= std::max(1e-6, 1e-6 * size),
              "solid: a face that is not planar");
    }
    require(!touches_itself(FaceOutline(*this, f).corners()), "solid: a face that touches itself");
  }
}

Solid block(const Vec3& foot, const Vec3& sides) {
  Solid out;
  for (int i = 0; i < 8; ++i) {
    out.vertices.push_back(foot + Vec3((i & 1 ? 0.5 : -0.5) * sides.x(),
                                       (i & 2 ? 0.5 : -0.5) * sides.y(),
                                       (i & 4 ? 1 : 0) * sides.z()));
  }
  out.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
  return out;
}

void add_solid(Solid& solid, const Solid& other) {
  const auto first = uint32_t(solid.vertices.size());
  solid.vertices.insert(solid.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (std::vector<uint32_t> face : other.faces) {
    for (uint32_t& i : face) i += first;
    solid.faces.push_back(std::move(face));
  }
}

Solid miniature() {
  constexpr double kLarge = 1, kSmall = 0.2, kBeside = (kLarge + kSmall) / 2;
  Solid out = block(Vec3::Zero(), Vec3::Constant(kLarge));
  add_solid(out, block({-kBeside, 0, 0}, Vec3::Constant(kSmall)));
  add_solid(out, block({0, -kBeside, 0}, Vec3::Constant(kSmall)));
  return out;
}

std::vector<size_t> miniature_patches() {
  std::vector<size_t> out;
  // Faces of a block, as seen from (−1, −1).
  constexpr size_t kFaces = 6, kTop = 1, kLeft = 5, kRight = 2;
  for (size_t cube = 0; cube < 3; ++cube) {
    for (const size_t face : {kTop, kLeft, kRight}) out.push_back(cube * kFaces + face);
  }
  return out;
}

SolidMesh triangulated(const Solid& solid) {
  solid.check();
  SolidMesh out;
  for (const Vec3& v : solid.vertices) out.mesh.vertices.push_back(v.cast<float>());
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const std::vector<uint32_t>& corner = solid.faces[f];
    for (const auto& [a, b, c] : ears(FaceOutline(solid, f).corners())) {
      out.mesh.triangles.push_back({corner[a], corner[b], corner[c]});
      out.mesh.hit.emplace_back();
      out.face.push_back(uint32_t(f));
    }
  }
  return out;
}

FaceOutline::FaceOutline(const Solid& solid, size_t face) {
  const std::vector<Vec3> corners = solid.corners(face);
  const Vec3 n = twice_area(corners).normalized();
  origin_ = corners[0];
  u_ = n.unitOrthogonal();
  v_ = n.cross(u_);
  for (const Vec3& c : corners) corner_.push_back(place(c));
}

bool FaceOutline::covers(const Vec3& p, double tolerance_m) const {
  const Place at = place(p);
  bool inside = false;
  double border = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < corner_.size(); ++i) {
    const Place &a = corner_[i], &b = corner_[(i + 1) % corner_.size()];
    if ((a.y() > at.y()) != (b.y() > at.y()) &&
        at.x() < a.x() + (at.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
    border = std::min(border, distance_to_segment(at, a, b));
  }
  constexpr double kOnEdge = 1e-9;
  return inside ? border >= -tolerance_m - kOnEdge : border <= tolerance_m + kOnEdge;
}

bool over_face(const Solid& solid, size_t face, const Vec3& p, double tolerance_m) {
  return FaceOutline(solid, face).covers(p, tolerance_m);
}

}  // namespace underbrush::studies
