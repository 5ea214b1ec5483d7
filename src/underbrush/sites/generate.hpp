/// \file
/// Generation of annotations for sites that do not exist.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/sites/drawn_site.hpp"

namespace underbrush::sites {

/// Standard deviation of ranges on a generated ground, m.
inline constexpr double kGroundNoiseM = 0.03;

/// Options of `generate_objects`.
struct GenerateOptions {
  std::string kind = "forest";  ///< One of `site_kinds()`.
  double density = 0;           ///< Number per m² of the kind's main plants; 0 = the kind's own.
  uint64_t seed = 1;
  double margin_m = 0;      ///< m; no object stands nearer than this to the border of the ground.
  double patch_cell_m = 2;  ///< m; side of the cells of patches.
  Classes classes;          ///< The size of an object of another class is drawn again.
};

/// Returns the names of the kinds of sites.
///
/// | kind | trees per m² | shrubs per m² | patches |
/// |---|---|---|---|
/// | forest | **0.05**, half large | 0.02 | ferns: 10 % of the area |
/// | savanna | **0.003**, small and medium | 0.015 | 5 % |
/// | meadow | 0.0003 | **0.01**, low and small | 50 % |
///
/// The option `density` replaces the bold figure.
std::vector<std::string> site_kinds();

/// Generates the objects of a site part by part.
class SiteGenerator {
 public:
  /// `site` is the box of the whole ground seen from above (m, world). Throws as `generate_objects`
  /// does.
  SiteGenerator(const GenerateOptions& options, const Eigen::AlignedBox2d& site);
  ~SiteGenerator();

  /// Generates the objects that stand in `part` of the site (m, world), on its ground. They keep
  /// apart from the objects of the parts before. Parts with different numbers draw differently.
  DrawnSite objects(const primitives::GroundSurface& ground, const Eigen::AlignedBox2d& part,
                    uint64_t number);
  /// Forgets the objects below a line (m, world), which later parts do not come near.
  void forget_below(double y_m);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Generates a hilly ground with a track through it (`test_site::Terrain`) over [−x/2, x/2] ×
/// [−y/2, y/2] for the sides `size_m`, in triangles of side `spacing_m` (m). Throws as
/// `test_site::mesh_of_heights` does.
elements::Model generated_ground(const Eigen::Vector2d& size_m, double spacing_m, uint64_t seed);

/// Generates objects on the ground. Trees and shrubs are Poisson points that keep apart by their
/// crowns (in a forest, a tenth of the crowns' radii may overlap); patches grow where a smooth
/// random field is high. Boxes follow the kind's relations between height and crown. An object
/// whose class is not allowed after 1000 draws of its height is left out. The same seed gives the
/// same objects. Throws `std::invalid_argument` for an unknown kind, or a density that is negative
/// or above 10.
DrawnSite generate_objects(const primitives::GroundSurface& ground, const GenerateOptions& options);

}  // namespace underbrush::sites
