/// \file
/// Generation of annotations for sites that do not exist.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "underbrush/primitives/ground_surface.hpp"
#include "underbrush/primitives/placed_object.hpp"

namespace underbrush::primitives {

/// Options of `generate_objects`.
struct GenerateOptions {
  std::string kind = "forest";  ///< One of `site_kinds()`.
  double density = 0;           ///< Number per m² of the kind's main plants; 0 = the kind's own.
  uint64_t seed = 1;
  double margin_m = 0;      ///< m; nothing stands nearer than this to the border of the ground.
  double patch_cell_m = 2;  ///< m; side of the cells of patches.
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
  /// apart from those of the parts before. Parts with different numbers draw differently.
  std::vector<PlacedObject> objects(const GroundSurface& ground, const Eigen::AlignedBox2d& part,
                                    uint64_t number);
  /// Forgets what stands below a line (m, world), which parts from now on do not come near.
  void forget_below(double y_m);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Generates objects on the ground. Trees and shrubs are Poisson points that keep apart by their
/// crowns (in a forest, a tenth of the crowns' radii may overlap); patches grow where a smooth
/// random field is high. Boxes follow the kind's relations between height and crown. The same seed
/// gives the same objects. Throws `std::invalid_argument` for an unknown kind, or a density that is
/// negative or above 10.
std::vector<PlacedObject> generate_objects(const GroundSurface& ground,
                                           const GenerateOptions& options);

}  // namespace underbrush::primitives
