/// \file
/// This file computes the share of the light that the elements of a world reflect.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "underbrush/core/leaf_angle_distribution.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/simulate/dynamic_world.hpp"

namespace underbrush::simulate {

/// The classes and materials of a scene's instances. Both vectors may be empty.
struct InstanceKinds {
  std::vector<elements::Class> label;  ///< The class of each instance.
  std::vector<std::string> material;   ///< "" = the material of the class.
  /// Names of the classes that the scene has besides `elements::kClassNames`. The material of such
  /// a class is that of `Materials::of_class`, else the material of its name, else that of the
  /// class `unknown`.
  std::vector<std::string> class_names;
  /// Materials that the scene brings along, for the maker of the table of materials.
  std::vector<radiometry::Material> own_materials;
};

/// The kinds of a scene's instances.
InstanceKinds instance_kinds(const elements::Scene& scene, const elements::SceneInfo& info);
/// Adds the materials that a scene brings along to a table. One of a name that the table has
/// replaces that if `replaces`.
radiometry::Materials with_own_materials(radiometry::Materials table, const InstanceKinds& kinds,
                                         bool replaces = true);

/// Reflection factors at one wavelength: the reflectance times the effect of the incidence.
///
/// The material of an element is that of its instance if one is named, else that of its class.
/// Ground triangles have the class `ground`. Other elements have the class of their instance; where
/// that is `unknown` or `ground`, an ellipsoid has the class of its own label and a surface
/// triangle `unknown`.
class Reflection {
  struct Material;

 public:
  /// Throws `std::invalid_argument` where a material does not exist.
  Reflection(const radiometry::Materials& materials, double wavelength_m,
             const InstanceKinds& kinds = {});

  /// An evaluation of the factors of beams one after another, which keeps the elements that it has
  /// evaluated lately. It serves a single thread.
  class Evaluator {
   public:
    Evaluator(const Reflection& reflection, const DynamicWorld& world);
    /// Starts a beam by its axis (unit vector, world) and time (s). It must be called before
    /// `factors`.
    void begin(const Vec3& axis, double time_s);
    /// Computes the factors of the elements that some `rays` of a beam met. `met` has the meetings
    /// of the rays with the numbers `sub_ray`. A triangle has ρ · `backscatter` at the angle to its
    /// normal, whichever side is lit. An ellipsoid has ρ · `LeafAngleDistribution::backscatter` at
    /// the angle between the beam's axis and the instance's own vertical, because leaves tilt with
    /// their plant. Matter in unknown space reflects as ellipsoids without a class do.
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
    uint32_t instance_ =
        trace::Intersection::kNone;  ///< The instance that the next four fields describe.
    Vec3 up_ = Vec3::UnitZ();        ///< Its vertical, world.
    const elements::Model* model_ = nullptr;
    uint32_t first_ellipsoid_ = 0;
    int material_ = -1;  ///< Material of all elements but the ground; −1 = by element.
    std::vector<Triangle> triangles_;
    std::vector<float> leaves_;  ///< Factors by material at `cos_zenith_`; < 0 = not yet computed.
  };

 private:
  struct Material {
    double reflectance;
    double a, b;  ///< Backscatter a cos θ + b sin² θ; unused for Phong.
    radiometry::SurfaceModel surface;
    LeafAngleDistribution leaf_angles;
  };
  /// The material of all elements of an instance but the ground, or −1 if it depends on the
  /// element.
  int material_of(uint32_t instance) const;

  std::vector<Material> materials_;
  std::vector<uint8_t> of_class_;  ///< Index of the material, by class.
  std::vector<elements::Class> label_;
  std::vector<int> of_instance_;  ///< Index of the material, or −1.
};

}  // namespace underbrush::simulate
