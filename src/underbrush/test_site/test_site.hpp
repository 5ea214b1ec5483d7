/// \file
/// A generated off-road site whose truth is known down to the single leaf; `underbrush demo` scans
/// it.
#pragma once
#include <string>
#include <vector>

#include "underbrush/elements/classes.hpp"
#include "underbrush/test_site/drive.hpp"
#include "underbrush/test_site/plant_mesh.hpp"
#include "underbrush/test_site/prototypes.hpp"
#include "underbrush/test_site/terrain.hpp"

namespace underbrush {
/// Generated sites, and plants made of fine triangles.
namespace test_site {

/// Parameters of a site.
struct SiteParameters {
  TerrainParameters terrain;
  DriveParameters drive;
  int trees = 25;                  ///< Number of trees, 4 to 15 m high.
  int shrubs = 80;                 ///< Number of shrubs, 0.3 to 3 m high.
  double tussocks_per_m2 = 4;      ///< Density where tall grass stands.
  double mowed_per_m2 = 3;         ///< Tufts of short grass on the verges.
  double ground_spacing_m = 0.25;  ///< m; spacing of the ground mesh.
  double ground_margin_m = 10;     ///< m; width of the bare ground around the site.
  uint64_t seed = 1;
};

/// A prototype placed in the world: x ↦ pose · (scale · x).
struct Placement {
  uint32_t prototype = 0;
  Pose world_from_plant;  ///< Upright: turned about z only.
  double scale = 1;
  elements::Class label = elements::Class::kUnknown;  ///< Class of the height as placed.
  uint32_t instance = 0;                              ///< Counts from 1; 0 is the ground.
};

/// A site in parts: its plants are prototypes that are placed many times.
struct Site {
  SiteParameters parameters;
  Terrain terrain;
  std::vector<Prototype> prototypes;
  std::vector<Placement> placements;
  Trajectory world_from_sensor;  ///< The drive of the sensor.
};

/// Makes a site; the same parameters give the same site on any number of threads. The crowns of
/// trees and shrubs keep clear of the track. Where no room is left, fewer plants are placed than
/// asked for. Throws `std::invalid_argument` for negative numbers of plants, and as `Terrain` and
/// `drive` do.
Site make_site(const SiteParameters& parameters);

/// A site as one world of opaque triangles, with the class, instance and part of each triangle.
struct FlatSite {
  elements::Model model;               ///< Has `ground` and `surface`, but no ellipsoids.
  std::vector<elements::Class> label;  ///< One for each element of the model, in its numbering.
  std::vector<uint32_t> instance;      ///< One for each element of the model; 0 for the ground.
  std::vector<Part> part;              ///< One for each element of the model.
};
/// Turns a site into one model, with every placement as triangles of its own.
FlatSite flatten(const Site& site);

}  // namespace test_site
}  // namespace underbrush
