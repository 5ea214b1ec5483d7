#include "underbrush/fit/volumetric.hpp"

#include <algorithm>
#include <stdexcept>

namespace underbrush::fit {
namespace {

/// A clustering under its name.
struct Fitter {
  std::string_view name;
  Clusters (*clusters)(const VolumetricPoints&, const VolumetricOptions&, uint64_t seed);
};

constexpr Fitter kFitters[] = {
    {"hierarchical",
     [](const VolumetricPoints& p, const VolumetricOptions& o, uint64_t seed) {
       return hierarchical_clusters(p.point, o.hierarchical, seed);
     }},
    {"voxel", [](const VolumetricPoints& p, const VolumetricOptions& o,
                 uint64_t) { return voxel_clusters(p.point, o.voxel); }},
    {"top_down", [](const VolumetricPoints& p, const VolumetricOptions& o,
                    uint64_t) { return top_down_clusters(p.point, p.to_sensor, o.top_down); }},
    {"bottom_up", [](const VolumetricPoints& p, const VolumetricOptions& o,
                     uint64_t) { return bottom_up_clusters(p.point, o.bottom_up); }},
};

}  // namespace

std::vector<std::string> volumetric_fitters() {
  std::vector<std::string> names;
  for (const Fitter& f : kFitters) names.emplace_back(f.name);
  return names;
}

Clusters clusters_of(std::string_view name, const VolumetricPoints& points,
                     const VolumetricOptions& options, uint64_t seed) {
  for (const Fitter& f : kFitters) {
    if (f.name == name) return f.clusters(points, options, seed);
  }
  throw std::invalid_argument("fit: no volumetric fitter '" + std::string(name) + "'");
}

Volumes volumes(std::string_view name, const VolumetricPoints& points,
                const VolumetricOptions& options, uint64_t seed) {
  const Clusters clusters = clusters_of(name, points, options, seed);
  return {name == "hierarchical" ? mixture(points.point, points.to_sensor, clusters,
                                           options.ellipsoid, options.mixture)
                                 : ellipsoids_of(points.point, clusters, options.ellipsoid),
          size_t(std::count(clusters.group.begin(), clusters.group.end(), Clusters::kNone))};
}

}  // namespace underbrush::fit
