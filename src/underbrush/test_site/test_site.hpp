/// \file
/// A generated off-road site whose truth is known to the leaf: what `underbrush demo` scans.
#pragma once
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/test_site/drive.hpp"
#include "underbrush/test_site/plant_mesh.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush {
/// Scenes: generated sites and plants of fine triangles.
namespace test_site {

/// What the site holds.
struct SiteParameters {
  TerrainParameters terrain;
  DriveParameters drive;
  int trees = 25;              ///< 4 to 15 m high.
  int shrubs = 80;             ///< 0.3 to 3 m high.
  double tussocks_per_m2 = 4;  ///< Where tall grass stands.
  double mowed_per_m2 = 3;     ///< Tufts of short grass on the verges.
  double ground_spacing_m = 0.25;
  double ground_margin_m = 10;  ///< Bare ground around the site.
  uint64_t seed = 1;
};

/// A plant at the identity pose: base at the origin, z up.
struct Prototype {
  std::string name;
  PlantMesh plant;
  double height_m = 0;  ///< Of its highest vertex.
  double radius_m = 0;  ///< Of the vertical cylinder about the origin that holds it.
};

/// A prototype in the world: x ↦ pose · (scale · x).
struct Placement {
  uint32_t prototype = 0;
  Pose world_from_plant;  ///< Upright; turned about z only.
  double scale = 1;
  elements::Class label = elements::Class::kUnknown;  ///< By the height as placed.
  uint32_t instance = 0;                              ///< From 1; 0 is the ground.
};

/// The site in parts: plants are prototypes placed many times.
struct Site {
  SiteParameters parameters;
  Terrain terrain;
  std::vector<Prototype> prototypes;
  std::vector<Placement> placements;
  Trajectory world_from_sensor;  ///< The drive.
};

/// The same site for the same parameters on any number of threads. Trees and shrubs keep clear of
/// the track with their whole crown; where there is no room left, fewer are placed than asked for.
Site make_site(const SiteParameters& parameters);

/// The site as one world of opaque triangles, and whose each of them is.
struct FlatSite {
  elements::Model model;               ///< `ground` and `surface`, no ellipsoids.
  std::vector<elements::Class> label;  ///< One per element of the model, in its numbering.
  std::vector<uint32_t> instance;      ///< Likewise; 0 for ground.
  std::vector<Part> part;              ///< Likewise.
};
/// Every placement as triangles of its own.
FlatSite flatten(const Site& site);

}  // namespace test_site
}  // namespace underbrush
