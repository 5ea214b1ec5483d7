/// \file
/// Solids by their boundary: planar faces with straight edges, for the targets of [kim12].
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/elements/model.hpp"

namespace underbrush::studies {

/// Faces over shared corners. A face lists its corners counter-clockwise as seen from outside. It
/// may be non-convex but must not touch itself.
struct Solid {
  std::vector<Vec3> vertices;  ///< m.
  std::vector<std::vector<uint32_t>> faces;

  /// Throws `std::invalid_argument` where a face has fewer than three corners, a corner does not
  /// exist or is not finite, a face has no area or touches itself, or a corner lies more than 10⁻⁶
  /// of the face's size (and 1 µm) off its plane.
  void check() const;
  /// Returns the unit normal of a face, which points outwards.
  Vec3 normal(size_t face) const;
  /// Returns the corners of a face (m).
  std::vector<Vec3> corners(size_t face) const;
};

/// Returns a block with these side lengths (m), whose bottom has its centre at `foot`. Its faces
/// are the bottom, the top, and the sides towards −y, +x, +y, −x.
Solid block(const Vec3& foot, const Vec3& sides);

/// Appends all faces of `other`.
void add_solid(Solid& solid, const Solid& other);

/// Returns the miniature of [kim12] fig. 4: a cube of 1 m with the centre of its bottom at the
/// origin, and two cubes of 0.2 m on the ground that touch the middles of its sides towards −x and
/// −y. Nine faces, `miniature_patches`, are visible from the diagonal before (−1, −1).
Solid miniature();
/// Returns the faces of the nine patches in the paper's order: top, left side and right side, as
/// seen from the scanner, of the large cube and of each small one.
std::vector<size_t> miniature_patches();

/// Triangles of all faces, and the face that each belongs to.
struct SolidMesh {
  elements::TriangleMesh mesh;  ///< Opaque.
  std::vector<uint32_t> face;   ///< One for each triangle.
};
/// Cuts the solid into triangles, by ear clipping.
SolidMesh triangulated(const Solid& solid);

/// The outline of a face in the face's own plane, prepared for testing many points.
class FaceOutline {
 public:
  /// Prepares the outline of a face. The solid must pass `Solid::check`.
  FaceOutline(const Solid& solid, size_t face);
  /// Whether `p` lies over or under the face, with the tolerance of `over_face`.
  bool covers(const Vec3& p, double tolerance_m = 0) const;
  /// Returns the corners, counter-clockwise.
  const std::vector<Eigen::Vector2d>& corners() const { return corner_; }

 private:
  Eigen::Vector2d place(const Vec3& p) const { return {u_.dot(p - origin_), v_.dot(p - origin_)}; }

  Vec3 origin_, u_, v_;
  std::vector<Eigen::Vector2d> corner_;
};

/// Whether `p` lies over or under the face: inside its outline, or within `tolerance_m` of it. A
/// negative tolerance demands that distance from the border. A point on an edge is inside.
bool over_face(const Solid& solid, size_t face, const Vec3& p, double tolerance_m = 0);

/// Reads a solid from Wavefront OBJ (`v` and `f`; all else is ignored), or from JSON (by the
/// extension) {"vertices": [[x, y, z], …], "faces": [[0, 1, 2, …], …]} with indices from 0. Throws
/// `FormatError` where the file is malformed or fails `Solid::check`.
Solid read_solid(const std::filesystem::path& path);

}  // namespace underbrush::studies
