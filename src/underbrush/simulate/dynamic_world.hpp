/// \file
/// The world that beams are fired into: static elements and objects that move through it.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "underbrush/trace/world.hpp"

namespace underbrush::simulate {

/// A static world and the movers in it. Each beam meets a mover where that is at the beam's own
/// time. With movers that stand still, the answers are those of the scene itself, to rounding:
/// instances keep their numbers, and so their random numbers.
class DynamicWorld {
 public:
  /// Nothing moves. `world` must outlive this.
  DynamicWorld(const trace::World& world);  // NOLINT(google-explicit-constructor)
  /// The scene with some of its instances moving. Throws `std::invalid_argument` where a mover's
  /// instance does not exist or comes twice, or its trajectory is empty. `scene` must outlive this.
  DynamicWorld(const elements::Scene& scene, std::vector<elements::Mover> movers);
  DynamicWorld(DynamicWorld&&) noexcept;
  ~DynamicWorld();

  /// As `World::nearest_accepted`, for beams of `rays.size() / time_s.size()` rays each, one beam
  /// after the other, fired at `time_s`.
  void nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                        std::span<const double> time_s, const trace::RangeLimits& limits,
                        std::span<trace::Intersection> met) const;

  const trace::World& world() const { return *world_; }
  bool moves() const { return !movers_.empty(); }
  const elements::Model& model(uint32_t instance) const;
  /// Where an instance is at a time.
  elements::Instance placed(uint32_t instance, double time_s) const;

 private:
  struct Object;
  const Object* object(uint32_t instance) const;

  const trace::World* world_ = nullptr;
  std::unique_ptr<elements::Scene> still_;  ///< The scene, an empty model in place of each mover.
  std::unique_ptr<trace::World> own_;
  std::vector<std::unique_ptr<Object>> movers_;
};

}  // namespace underbrush::simulate
