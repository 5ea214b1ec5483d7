#include <algorithm>

#include "studies/vegetation.hpp"

namespace underbrush::studies {
namespace {

/// Returns the surface of [deschaud12] §V.C. The weight of a point ends at `radius_m`.
fit::FitOptions surface(double cell_m, double radius_m) {
  fit::FitOptions f;
  f.fitter = "rimls";
  f.surface.cell_m = cell_m;
  f.surface.kernel_m = f.surface.least_kernel_m = radius_m;
  f.surface.noise_m = 0.005;
  return f;
}

/// Returns the voxels of [deschaud12] §III, as in share/configs/vegetation-paper.yaml.
fit::FitOptions voxel(double side_m) {
  fit::FitOptions f;
  f.fitter = "voxel";
  f.tau = 2;
  f.volumetric.voxel = {side_m, 1, true};
  f.volumetric.ellipsoid.prior_points = 0;
  f.credit.rule = "mahalanobis";
  f.credit.ellipsoid = {0, 0};
  f.free_space_below = 0;
  f.segment.method = "none";
  f.ranges_as_given = true;
  return f;
}

/// Returns options for many measurements of each direction, where the counts need no prior.
fit::FitOptions dense(const std::string& fitter) {
  fit::FitOptions f;
  f.fitter = fitter;
  f.tau = 2;
  f.credit.rule = "best";
  f.credit.ellipsoid = {0, 0};
  f.free_space_below = 0;
  f.likelihood.maximisation.prior_hits = 0;
  f.volumetric.top_down.min_points = 5;
  f.volumetric.bottom_up.cell_m = 0.005;
  f.volumetric.bottom_up.largest_m = 0.1;
  return f;
}

}  // namespace

std::vector<Contender> static_contenders(uint64_t seed) {
  // The paper's kernel of 4 cm is taken as the width h of a Gaussian e^{−(r/h)²}, which the weight
  // (1 − r²/(2h)²)⁴ approximates. With a radius of 4 cm, lasers 47 mm apart, as at 8 m, would not
  // join.
  const fit::FitOptions mesh = surface(0.01, 0.08);
  std::vector<Contender> out{{kDefault, {}, false, true},
                             {"default with options", {}, false, true},
                             {"default with options, anew", {}},
                             {"surface, cone", mesh, true},
                             {"surface, axis", mesh, false},
                             {"voxel, cone", voxel(0.05), true},
                             {"voxel", voxel(0.05), false},
                             {"top_down", dense("top_down"), false},
                             {"bottom_up", dense("bottom_up"), false},
                             {"hierarchical", dense("hierarchical"), false},
                             {"hierarchical, first", dense("hierarchical"), false}};
  out.back().fit.credit.rule = "first";
  out.push_back({"likelihood", dense("likelihood"), false});
  for (Contender& c : out) {
    c.fit.seed = seed;
    if (c.name == kDefault) continue;
    c.fit.segment.method = "none";
    // This is the rounding of the range count. The spread of hundreds of points contains the noise
    // already, and a floor as wide as the noise would thicken what is flat and stands oblique to
    // the beam.
    c.fit.range_noise_m = 0.002;
  }
  return out;
}

std::vector<Contender> mobile_contenders(uint64_t seed) {
  std::vector<Contender> out{{kDefault, {}, false, true},
                             {"default, anew", {}},
                             {"surface", surface(0.3, 0.4)},
                             {"voxel", voxel(0.3)}};
  for (const char* name : {"top_down", "bottom_up", "hierarchical"}) {
    out.push_back({name, {}});
    out.back().fit.fitter = name;
  }
  out.push_back({"hierarchical, best", {}});
  out.back().fit.fitter = "hierarchical";
  out.back().fit.credit.rule = "best";
  for (Contender& c : out) c.fit.seed = seed;
  return out;
}

}  // namespace underbrush::studies
