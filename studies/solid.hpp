/// \file
/// Solids by their boundary: planar faces with straight edges, the targets of [kim12].
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::studies {

/// Faces over shared corners. A face lists its corners counter-clockwise seen from outside; it may
/// be non-convex but must not touch itself.
struct Solid {
  std::vector<Vec3> vertices;  ///< m.
  std::vector<std::vector<uint32_t>> faces;

  /// Throws `std::invalid_argument` where a face has fewer than three corners, a corner does not
  /// exist or is not finite, a face has no area or touches itself, or a corner lies more than 10⁻⁶
  /// of the face's size (and 1 µm) off its plane.
  void check() const;
  /// Unit, outwards, and a point of the face.
  Vec3 normal(size_t face) const;
  std::vector<Vec3> corners(size_t face) const;
};

/// A block with these sides, its foot's middle at `foot`; faces: bottom, top, then the sides
/// towards −y, +x, +y, −x.
Solid block(const Vec3& foot, const Vec3& sides);

/// Appends all faces of `other`.
void add_solid(Solid& solid, const Solid& other);

/// The miniature of [kim12] fig. 4: a cube of 1 m, its foot's middle at the origin, and two cubes
/// of 0.2 m on the ground that touch the middles of its sides towards −x and −y. A scanner on the
/// diagonal before (−1, −1) sees nine faces, `miniature_patches`.
Solid miniature();
/// Faces of the nine patches in the paper's order: of the large cube and each small one, top, left
/// side, right side, as that scanner sees them.
std::vector<size_t> miniature_patches();

/// Triangles of all faces (ears cut off), and of which face each is.
struct SolidMesh {
  elements::TriangleMesh mesh;  ///< Opaque.
  std::vector<uint32_t> face;   ///< One per triangle.
};
/// The solid as triangles.
SolidMesh triangulated(const Solid& solid);

/// A face's outline in its own plane, ready for many points.
class FaceOutline {
 public:
  /// Of a face of a solid that passes `Solid::check`.
  FaceOutline(const Solid& solid, size_t face);
  /// As `over_face`.
  bool covers(const Vec3& p, double tolerance_m = 0) const;
  /// Counter-clockwise.
  const std::vector<Eigen::Vector2d>& corners() const { return corner_; }

 private:
  Eigen::Vector2d place(const Vec3& p) const { return {u_.dot(p - origin_), v_.dot(p - origin_)}; }

  Vec3 origin_, u_, v_;
  std::vector<Eigen::Vector2d> corner_;
};

/// Whether `p` lies over or under the face: inside its outline, or within `tolerance_m` of it; a
/// negative tolerance asks for that much distance from the border. A point on an edge is inside.
bool over_face(const Solid& solid, size_t face, const Vec3& p, double tolerance_m = 0);

/// Reads a solid: Wavefront OBJ (`v` and `f`; all else is passed over), or JSON (by the extension)
/// {"vertices": [[x, y, z], …], "faces": [[0, 1, 2, …], …]} with indices from 0. Throws
/// `FormatError` where the file is malformed or is no solid by `Solid::check`.
Solid read_solid(const std::filesystem::path& path);

}  // namespace underbrush::studies
