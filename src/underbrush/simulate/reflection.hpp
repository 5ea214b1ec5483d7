/// \file
/// What share of the light the elements of a world send back.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/radiometry/leaf_angle_distribution.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/simulate/dynamic_world.hpp"

namespace underbrush::simulate {

/// What the instances of a scene are made of; both may be empty.
struct InstanceKinds {
  std::vector<elements::Class> label;  ///< One an instance.
  std::vector<std::string> material;   ///< One an instance; "" = that of the class.
};

/// Reflection factors at one wavelength: reflectance × what the incidence leaves of it.
///
/// The material of an element is the one named for its instance; else that of its class: ground
/// triangles are `ground`; anything else is of its instance's class, or, where that says nothing
/// (`unknown`, `ground`), an ellipsoid of its own label and a surface triangle `unknown`.
class Reflection {
  struct Material;

 public:
  /// Throws `std::invalid_argument` where a material does not exist.
  Reflection(const radiometry::Materials& materials, double wavelength_m,
             const InstanceKinds& kinds = {});

  /// Evaluates the factors of the sub-rays of one beam after another and keeps the elements that it
  /// has evaluated lately. One thread at a time may use it.
  class Evaluator {
   public:
    Evaluator(const Reflection& reflection, const DynamicWorld& world);
    /// To be called before the sub-rays of a beam: its axis and time.
    void begin(const Vec3& axis, double time_s);
    /// The factors of what some of a beam's `rays` met, those of the numbers `sub_ray`: of a
    /// triangle ρ · `backscatter` at the angle to its normal, whichever side is lit; of an
    /// ellipsoid ρ · `LeafAngleDistribution::backscatter` at the angle of the beam's axis to the
    /// instance's own vertical: leaves tilt with what they grow on.
    void factors(std::span<const trace::Intersection> met, std::span<const Ray> rays,
                 std::span<const uint32_t> sub_ray, std::span<float> factor);

   private:
    struct Triangle {
      uint32_t instance = trace::Intersection::kNone, element = 0;
      Vec3 normal = Vec3::Zero();  ///< World.
      const Material* material = nullptr;
    };
    static constexpr size_t kRemembered = 256;
    void enter(uint32_t instance);
    void remember(const trace::Intersection& met, Triangle& t);
    float leaves(size_t material);

    const Reflection& reflection_;
    const DynamicWorld& world_;
    void set_zenith();

    Vec3 axis_ = Vec3::UnitX();
    double time_s_ = 0, cos_zenith_ = 0;
    uint32_t instance_ = trace::Intersection::kNone;  ///< That the next four are of.
    Vec3 up_ = Vec3::UnitZ();                         ///< Its vertical, world.
    const elements::Model* model_ = nullptr;
    uint32_t first_ellipsoid_ = 0;
    int material_ = -1;  ///< Of all but the ground, or −1: as the element says.
    std::vector<Triangle> triangles_;
    std::vector<float> leaves_;  ///< By material, at `cos_zenith_`; < 0 = not yet evaluated.
  };

 private:
  struct Material {
    double reflectance;
    double a, b;  ///< Backscatter a cos θ + b sin² θ; unused for Phong.
    radiometry::SurfaceModel surface;
    radiometry::LeafAngleDistribution leaf_angles;
  };
  /// Of all elements of an instance but the ground, or −1.
  int material_of(uint32_t instance) const;

  std::vector<Material> materials_;
  std::vector<uint8_t> of_class_;  ///< Index of the material, by class.
  std::vector<elements::Class> label_;
  std::vector<int> of_instance_;  ///< Index of the material, or −1.
};

}  // namespace underbrush::simulate
