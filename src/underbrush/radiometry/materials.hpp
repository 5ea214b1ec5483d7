/// \file
/// What things are made of: reflectance by wavelength, and how they send light back.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/radiometry/brdf.hpp"

namespace underbrush::radiometry {

/// A material.
struct Material {
  std::string name;
  /// (wavelength m, reflectance), in rising order of wavelength.
  std::vector<std::pair<double, double>> reflectance;
  SurfaceModel surface;
  double leaf_shape = 1;  ///< χ of `LeafAngleDistribution`, where it fills ellipsoids.

  /// By linear interpolation; the first or last value outside the table.
  double reflectance_at(double wavelength_m) const;
};

/// Materials, and which of them each class of object is made of.
struct Materials {
  std::vector<Material> material;
  std::vector<std::pair<std::string, std::string>> of_class;  ///< Class name, material name.
  std::vector<std::string> sources;

  /// Throws `std::invalid_argument`, naming the nearest one, if there is none of that name.
  const Material& named(std::string_view name) const;
  /// That of the class, or that of `unknown`.
  const Material& of(std::string_view class_name) const;
};

/// The table built in (share/materials/materials.yaml), or that of the YAML file at `path`. Throws
/// `FormatError` where it is malformed.
Materials load_materials(std::string_view path = {});

}  // namespace underbrush::radiometry
