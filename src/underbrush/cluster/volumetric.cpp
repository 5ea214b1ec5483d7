#include "underbrush/cluster/volumetric.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace underbrush::cluster {
namespace {

constexpr Clustering kClusterings[] = {
    {"hierarchical",
     [](const VolumetricPoints& p, const VolumetricOptions& o, uint64_t seed) {
       return hierarchical_clusters(p.point, o.hierarchical, seed);
     },
     /*mixture=*/true},
    {"voxel",
     [](const VolumetricPoints& p, const VolumetricOptions& o, uint64_t) {
       return voxel_clusters(p.point, o.voxel);
     },
     /*mixture=*/false, /*in_voxels=*/true},
    {"top_down", [](const VolumetricPoints& p, const VolumetricOptions& o,
                    uint64_t) { return top_down_clusters(p.point, o.top_down); }},
    {"bottom_up", [](const VolumetricPoints& p, const VolumetricOptions& o,
                     uint64_t) { return bottom_up_clusters(p.point, o.bottom_up); }},
};

const Clustering& known(std::string_view name) {
  const Clustering* clustering = clustering_named(name);
  if (!clustering) {
    throw std::invalid_argument("fit: no volumetric fitter '" + std::string(name) + "'");
  }
  return *clustering;
}

}  // namespace

std::span<const Clustering> clusterings() { return kClusterings; }

const Clustering* clustering_named(std::string_view name) {
  for (const Clustering& c : kClusterings) {
    if (c.name == name) return &c;
  }
  return nullptr;
}

Clusters clusters_of(std::string_view name, const VolumetricPoints& points,
                     const VolumetricOptions& options, uint64_t seed) {
  return known(name).clusters(points, options, seed);
}

Volumes volumes(std::string_view name, const VolumetricPoints& points,
                const VolumetricOptions& options, uint64_t seed) {
  const Clustering& clustering = known(name);
  const Clusters clusters = clustering.clusters(points, options, seed);
  Volumes out;
  std::vector<bool> kept;
  if (clustering.mixture) {
    out.ellipsoids = mixture(points.point, points.to_sensor, clusters, options.ellipsoid,
                             options.mixture, &kept);
  } else {
    out.ellipsoids = ellipsoids_of(points.point, clusters, options.ellipsoid);
    kept.assign(out.ellipsoids.size(), true);
  }
  out.unclustered_points =
      size_t(std::count(clusters.group.begin(), clusters.group.end(), Clusters::kNone));
  if (options.spacing == BeamSpacing()) return out;
  const std::vector<Eigen::Matrix3f> open =
      open_covariances(points.point, points.to_sensor, clusters, options.spacing);
  for (size_t c = 0; c < open.size(); ++c) {
    if (kept[c]) out.open.push_back(open[c]);
  }
  const double least = options.ellipsoid.least_m();
  for (size_t k = 0; k < out.open.size(); ++k) {
    elements::Ellipsoid& e = out.ellipsoids[k];
    e.set_covariance(elements::floored_covariance(
        e.covariance_matrix(), out.open[k].cast<double>() + least * least * Mat3::Identity()));
  }
  return out;
}

}  // namespace underbrush::cluster
