/// \file
/// What share of the light the elements of a world send back.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/radiometry/foliage.hpp"
#include "underbrush/radiometry/materials.hpp"
#include "underbrush/simulate/surroundings.hpp"

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
  struct Coat;

 public:
  /// Throws `std::invalid_argument` where a material does not exist.
  Reflection(const radiometry::Materials& materials, double wavelength_m,
             const InstanceKinds& kinds = {});

  /// Asks for the factors of one beam's sub-rays after another; remembers the last triangle and the
  /// last leaves. For one thread.
  class Asker {
   public:
    Asker(const Reflection& reflection, const Surroundings& surroundings);
    /// To be called before the sub-rays of a beam: its axis and time.
    void begin(const Vec3& axis, double time_s);
    /// The factor of what a sub-ray with `direction` met: of a triangle ρ · `backscatter` at the
    /// angle to its normal, whichever side is lit; of an ellipsoid ρ · `Foliage::backscatter` at the
    /// zenith angle of the beam's axis.
    float factor(const trace::Met& met, const Vec3& direction);

   private:
    void see_triangle(const trace::Met& met);

    const Reflection& reflection_;
    const Surroundings& surroundings_;
    double time_s_ = 0, cos_zenith_ = 0;
    trace::Met last_;               ///< The triangle that is remembered.
    Vec3 normal_ = Vec3::Zero();    ///< Its normal, world.
    const Coat* coat_ = nullptr;    ///< What it is made of.
    std::vector<float> leaves_;  ///< By material, of this beam; < 0 = not yet asked for.
  };

 private:
  struct Coat {
    double reflectance;
    double a, b;  ///< Backscatter a cos θ + b sin² θ; unused for Phong.
    radiometry::SurfaceModel surface;
    radiometry::Foliage foliage;
  };
  uint8_t coat_of(const Surroundings& s, const trace::Met& met, elements::Kind kind) const;

  std::vector<Coat> coats_;
  std::vector<uint8_t> of_class_;  ///< Index of the coat, by class.
  std::vector<elements::Class> label_;
  std::vector<int> of_instance_;  ///< Index of the coat, or −1.
};

}  // namespace underbrush::simulate
