/// \file
/// Sites like a given one: fitted to the objects and the ground of a site, drawn on any ground.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "underbrush/sites/drawn_site.hpp"
#include "underbrush/sites/ground_waves.hpp"
#include "underbrush/sites/pieces.hpp"
#include "underbrush/sites/point_process.hpp"
#include "underbrush/sites/statistics.hpp"

namespace underbrush::sites {

/// The model of a site, fitted to its objects.
struct SiteModel {
  Window window;              ///< The part of the site that its objects cover.
  std::vector<Piece> pieces;  ///< The plants and pieces of patches in the window.
  PointProcess process;
  double cell_m = 2;  ///< m; side of the cells of patches.
};

/// Fits the densities of the classes, the point process of the places and the sizes of the objects
/// of a site on its ground. `cell_m` (m) is the side of cells of patches. The same seed gives the
/// same bits. Throws `DataError` where fewer than 10 pieces stand on the ground.
SiteModel fit_site(const primitives::GroundSurface& ground,
                   std::span<const primitives::PlacedObject> objects, double cell_m, uint64_t seed);

/// Options of `draw_site`.
struct DrawOptions {
  uint64_t seed = 1;
  double margin_m = 0;  ///< m; no object stands nearer than this to the border of the ground.
  Classes classes;      ///< An object of another class is replaced by one of the site of its kind.
};

/// Draws a site on a ground. The number of pieces of each class is its density times the area; each
/// is one of the site's own with its size and the places of its points, and their places are drawn
/// by the point process. No two cells of patches lie upon each other: further pieces make up for
/// the cells that found no room. The same seed gives the same objects.
DrawnSite draw_site(const SiteModel& model, const primitives::GroundSurface& ground,
                    const DrawOptions& options);

/// Returns a ground like that of a site: with the spectrum of its heights, its noise, and the means
/// of its hit probabilities and roughness, over [−x/2, x/2] × [−y/2, y/2] for the sides `size_m` in
/// triangles of side `spacing_m` (m). Throws as `ground_with` does.
elements::Model ground_like(const elements::Model& site, const Eigen::Vector2d& size_m,
                            double spacing_m, uint64_t seed);

/// A statistic of a site beside those of sites that were drawn on its own ground.
struct ComparedStatistic {
  Statistic site;
  double mean = 0, low = 0, high = 0;  ///< Over the drawn sites; `low` and `high` are the ends of
                                       ///< the interval that holds 95 % of sites.
};

/// Compares the objects of a site with those of `draws` sites that are drawn on its ground, in the
/// window of the model, and its ground with as many that are drawn like it. The interval is mean ±
/// 1.96 standard deviations, NaN where fewer than two sites have the statistic.
std::vector<ComparedStatistic> compare_with_draws(const SiteModel& model,
                                                  const elements::Model& ground,
                                                  std::span<const primitives::PlacedObject> objects,
                                                  size_t draws, uint64_t seed);

}  // namespace underbrush::sites
