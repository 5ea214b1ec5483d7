/// \file
/// This file has the world that beams are fired into: static elements and objects that move through
/// it.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// A static world and the moving objects in it. Each beam meets an object where that is at the
/// beam's own time. Instances keep their numbers, and so their random numbers. Where all objects
/// stand still, the answers are therefore those of the scene, up to rounding.
class DynamicWorld {
 public:
  /// A world without moving objects. `world` must outlive this.
  DynamicWorld(const trace::World& world);  // NOLINT(google-explicit-constructor)
  /// A scene of which some instances move. Throws `std::invalid_argument` where a mover's instance
  /// does not exist or occurs twice, or where its trajectory is empty. `scene` must outlive this.
  DynamicWorld(const elements::Scene& scene, std::vector<elements::Mover> movers,
               trace::Draws draws = trace::Draws::kAnew);
  DynamicWorld(DynamicWorld&&) noexcept;
  ~DynamicWorld();

  /// Finds the element at which each ray ends, as `World::nearest_accepted` does. Each of the times
  /// `time_s` (s) is that of a beam, and the rays of one beam follow those of another, `rays.size()
  /// / time_s.size()` each.
  void nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                        std::span<const double> time_s, const trace::RangeLimits& limits,
                        std::span<trace::Intersection> met) const;

  /// Computes the cell of the grain in which a ray of the time `time_s` (s) met an element, as
  /// `trace::grain_cell` does. The grain of a moving object moves with it. Where matter sways, the
  /// cell is the `swaying_cell` at the time of the ray's `key`.
  uint32_t grain_cell(const Ray& ray, double time_s, const trace::Intersection& met,
                      uint64_t key) const;

  const trace::World& world() const { return *world_; }
  bool moves() const { return !movers_.empty(); }
  const elements::Model& model(uint32_t instance) const;
  /// The place of an instance at a time (s).
  elements::Instance placed(uint32_t instance, double time_s) const;

 private:
  struct Object;
  const Object* object(uint32_t instance) const;
  uint32_t still_cell(const Ray& ray, double time_s, const trace::Intersection& met) const;

  const trace::World* world_ = nullptr;
  /// The scene with an empty model in place of each mover.
  std::unique_ptr<elements::Scene> still_;
  std::unique_ptr<trace::World> own_;
  std::vector<std::unique_ptr<Object>> movers_;
};

}  // namespace underbrush::simulate
