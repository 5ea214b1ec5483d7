/// \file
/// This file has materials: their reflectance by wavelength, and their reflection of light.
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
  /// Pairs of wavelength (m) and reflectance, in rising order of wavelength.
  std::vector<std::pair<double, double>> reflectance;
  SurfaceModel surface;
  double leaf_shape = 1;  ///< χ of `LeafAngleDistribution`, for ellipsoids of this material.

  /// The reflectance at a wavelength, by linear interpolation; outside the table, its first or last
  /// value.
  double reflectance_at(double wavelength_m) const;
};

/// A set of materials, and the material of each class of objects.
struct Materials {
  std::vector<Material> material;
  std::vector<std::pair<std::string, std::string>> of_class;  ///< Class name, material name.
  std::vector<std::string> sources;

  /// Finds a material by name. Throws `std::invalid_argument`, which names the most similar one,
  /// for an unknown name.
  const Material& named(std::string_view name) const;
  /// Finds the material of a class, or else that of the class `unknown`.
  const Material& of(std::string_view class_name) const;
};

/// Loads materials from the YAML file at `path`, or, if that is empty, the table built in
/// (share/materials/materials.yaml). Throws `FormatError` where the file is malformed.
Materials load_materials(std::string_view path = {});

}  // namespace underbrush::radiometry
