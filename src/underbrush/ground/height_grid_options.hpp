/// \file
/// The options of the surface through ground points.
#pragma once

namespace underbrush::ground {

/// Options of `HeightGrid`.
struct HeightGridOptions {
  double spacing_m = 0.5;       ///< m; least distance s of the nodes.
  double coarsest_m = 4;        ///< m; where fewer than 1.25 points lie in a cell that has one, in
                                ///< the mean over the map, s doubles, at most up to this. Airborne
                                ///< logs have such ground.
  double smoothness_m2 = 0.05;  ///< λ (m²): weight of the bending against the misfit.
  double padding_m = 1.5;       ///< m; nodes exist up to this far from a point ([tallavajhula18]'s
                                ///< code).
  double bridge_m = 10;  ///< m; nodes also fill gaps up to this width, where there is ground under
                         ///< crowns or in shadows that other beams will meet. The authors of
                         ///< [tallavajhula18] keep triangles with sides up to 10 m to the same end.
};

}  // namespace underbrush::ground
