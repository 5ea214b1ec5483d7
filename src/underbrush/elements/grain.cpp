#include "underbrush/elements/grain.hpp"

#include <cmath>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {
namespace {

struct Usual {
  std::string_view name;
  double side_m;
};

/// Orders of magnitude, from memory: blades of grass are 2 to 10 mm wide, leaves of shrubs 1 to
/// 4 cm, leaves of broad-leaved trees and shoots of conifers 3 to 10 cm, and a road of asphalt has
/// stones of about 1 cm. What is solid is even over more than a footprint.
constexpr double kLeafOfTree = 0.05, kLeafOfShrub = 0.03, kBlade = 0.01, kSolid = 0.3;
constexpr Usual kUsual[] = {
    {"grass", kBlade},
    {"low_shrub", 0.02},
    {"low_shrub_patch", 0.02},
    {"small_shrub", kLeafOfShrub},
    {"small_shrub_patch", kLeafOfShrub},
    {"medium_shrub", kLeafOfShrub},
    {"medium_shrub_patch", kLeafOfShrub},
    {"large_shrub", kLeafOfShrub},
    {"large_shrub_patch", kLeafOfShrub},
    {"bush", kLeafOfShrub},
    {"ground", 0.02},
    {"dirt", 0.02},
    {"terrain", kBlade},
    {"road", kBlade},
    {"asphalt", kBlade},
    {"car", kSolid},
    {"truck", kSolid},
    {"bus", kSolid},
    {"vehicle", kSolid},
    {"building", kSolid},
    {"concrete", kSolid},
    {"trunk", 0.1},
    {"log", 0.1},
};

}  // namespace

void Grain::check() const {
  const auto good = [](double side_m) { return std::isfinite(side_m) && side_m > 0; };
  require(good(ellipsoid_m) && good(mesh_m), "model: the grain must be positive");
  require(classes.size() <= kMostClasses, "model: more than 7 classes have a grain of their own");
  for (size_t k = 0; k < classes.size(); ++k) {
    require(good(classes[k].side_m), "model: the grain must be positive");
    require(place_of(classes[k].label) == k + 1, "model: a class has two grains");
  }
}

double usual_grain_m(std::string_view class_name) {
  for (const Usual& u : kUsual) {
    if (u.name == class_name) return u.side_m;
  }
  return kLeafOfTree;
}

}  // namespace underbrush::elements
