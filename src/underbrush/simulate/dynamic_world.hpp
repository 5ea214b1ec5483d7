/// \file
/// This file has the world that beams are fired into: static elements and objects that move through
/// it.
#pragma once
#include <array>
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

  /// The second half of `nearest_accepted`: replaces the elements `met` in the static world, or
  /// whatever else ends a ray at `Intersection::t_m`, by those of moving objects that are nearer.
  void meet_movers(std::span<const Ray> rays, std::span<const uint64_t> keys,
                   std::span<const double> time_s, const trace::RangeLimits& limits,
                   std::span<trace::Intersection> met) const;

  /// Gives an object that moves another trajectory and other times. Throws `std::invalid_argument`
  /// where the instance does not move or the trajectory is empty. Not while beams are answered.
  void move(const elements::Mover& mover);

  const trace::World& world() const { return *world_; }
  /// Whether the static world is one model in its own place.
  bool stands_as_one_model() const;
  bool moves() const { return !movers_.empty(); }
  bool moves(uint32_t instance) const { return object(instance) != nullptr; }
  const elements::Model& model(uint32_t instance) const;
  /// The reflectance of the matter in unknown space: near the ground (`is_low`) the mean of the
  /// model's ground, else that of its ellipsoids.
  const elements::MeanReflectance& unknown_reflectance(bool is_low) const {
    return unknown_reflectance_[size_t(is_low)];
  }
  /// The place of an instance at a time (s).
  elements::Instance placed(uint32_t instance, double time_s) const;

 private:
  struct Object;
  friend class MatterAt;
  const Object* object(uint32_t instance) const;

  const trace::World* world_ = nullptr;
  /// The scene with an empty model in place of each mover.
  std::unique_ptr<elements::Scene> still_;
  std::unique_ptr<trace::World> own_;
  std::vector<std::unique_ptr<Object>> movers_;
  std::array<elements::MeanReflectance, 2> unknown_reflectance_;
};

/// The matter that rays meet in a world: its model, and the cells of its grain. The grain of a
/// moving object moves with it. The data of an instance are kept until another one is asked
/// for.
class MatterAt {
 public:
  /// `world` must outlive it.
  explicit MatterAt(const DynamicWorld& world) : world_(world) {}

  /// The model of the element that a ray met.
  const elements::Model& model(const trace::Intersection& met, double time_s) {
    if (met.instance != instance_ || (moves_ && time_s != time_s_)) find(met.instance, time_s);
    return *model_;
  }
  /// Computes `trace::instance_key` of the element that a ray met, from the world's matter key.
  uint64_t key(uint64_t matter, const trace::Intersection& met, double time_s) {
    model(met, time_s);
    return matter ^ salt_;
  }
  /// Computes the cell of the grain in which a ray of the time `time_s` (s) met an element. Where
  /// matter sways, it is the `swaying_cell` at the time of the ray's `key`.
  uint32_t cell(const Ray& ray, double time_s, const trace::Intersection& met, uint64_t key) {
    model(met, time_s);
    const uint32_t cell = grain_.cell(moves_ ? in_object(ray) : ray, met);
    if (met.element < first_swaying_) return cell;
    return trace::swaying_cell(cell, met.element, uint32_t(key >> 32));
  }

 private:
  void find(uint32_t instance, double time_s);
  Ray in_object(const Ray& ray) const {
    return {object_from_world_ * ray.origin, object_from_world_.rotation * ray.direction};
  }

  const DynamicWorld& world_;
  uint32_t instance_ = trace::Intersection::kNone;
  const elements::Model* model_ = nullptr;
  trace::Grain grain_;
  uint64_t salt_ = 0;
  uint32_t first_swaying_ = trace::Intersection::kNone;  // the first element that sways
  bool moves_ = false;
  double time_s_ = 0;
  Pose object_from_world_;
};

}  // namespace underbrush::simulate
