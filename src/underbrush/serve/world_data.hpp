/// \file
/// Models, sets of primitives and scenes as a viewer reads them.
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "underbrush/elements/scene_file.hpp"
#include "underbrush/pipeline/world.hpp"
#include "underbrush/primitives/placed_object.hpp"
#include "underbrush/serve/opened_files.hpp"

namespace underbrush::serve {

/// A world in memory: a scene, a model as a scene of one instance, or a set of primitives, which
/// stand side by side in rows.
class WorldData {
 public:
  /// Reads the files. Throws `FormatError`.
  explicit WorldData(const OpenedFile& file);

  const elements::Scene& scene() const { return scene_; }
  const elements::SceneInfo& info() const { return info_; }
  const Vec3& origin() const { return origin_; }
  /// This world prepared for `simulate` with default options, when it is first needed. Its
  /// instances are numbered as those of `scene()`.
  const pipeline::TracedWorld& traced() const;

  /// Describes models and instances as JSON: places are relative to `origin_m`, and moving
  /// instances are at their first poses. Primitives have `box_m`, in their own frame.
  std::string json() const;
  /// Returns the thumbnail (PNG) of a primitive. Throws `std::invalid_argument` for another world
  /// or a primitive that does not exist, and `FormatError` where it has none.
  std::string thumbnail(size_t model) const;
  /// Returns a model's ellipsoids, 52 bytes each: mean, covariance (xx xy xz yy yz zz) and p as
  /// float32 in metres, then hits, misses and class as uint32. Throws `std::invalid_argument` for a
  /// model that does not exist.
  std::string ellipsoids(size_t model) const;
  /// Returns the ground or the surface of a model: the numbers of vertices and of triangles
  /// (uint32), vertices (3 × float32, m), triangles (3 × uint32), and for each triangle p
  /// (float32), then hits, then misses (uint32).
  std::string mesh(size_t model, elements::Kind kind) const;

 private:
  void place_primitives(const OpenedFile& file);
  std::vector<Pose> first_poses()
      const;  ///< The poses of instances; moving ones have their first pose.
  const elements::Model& model(size_t number) const;

  FileKind kind_;
  std::filesystem::path folder_;
  std::vector<primitives::Box> boxes_;  ///< The boxes of a set's primitives.
  elements::Scene scene_;
  elements::SceneInfo info_;
  Vec3 origin_ = Vec3::Zero();
  mutable std::once_flag prepared_;
  mutable std::unique_ptr<pipeline::TracedWorld> traced_;
};

}  // namespace underbrush::serve
