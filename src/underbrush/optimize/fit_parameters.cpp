#include "underbrush/optimize/fit_parameters.hpp"

#include <algorithm>
#include <type_traits>

namespace underbrush::optimize {
namespace {

template <class Field>
FitParameter entry(Parameter parameter, bool usual, Field field) {
  return {std::move(parameter), usual,
          [field](const fit::FitOptions& o) { return double(field(o)); },
          [field](fit::FitOptions& o, double value) {
            auto& x = field(o);
            x = std::remove_reference_t<decltype(x)>(value);
          }};
}

std::vector<FitParameter> of_hierarchical() {
  return {entry(
              {"clusters-per-point", 0.005, 0.5, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.volumetric.hierarchical.clusters_per_point; }),
          entry(
              {"min-points", 2, 30, Scale::kWhole}, true,
              [](auto& o) -> auto& { return o.volumetric.hierarchical.min_points; })};
}

std::vector<FitParameter> of_voxel() {
  return {entry(
      {"voxel-side", 0.05, 1, Scale::kLog}, true,
      [](auto& o) -> auto& { return o.volumetric.voxel.side_m; })};
}

std::vector<FitParameter> of_top_down() {
  return {entry(
              {"top-down-min-points", 3, 50, Scale::kWhole}, true,
              [](auto& o) -> auto& { return o.volumetric.top_down.min_points; }),
          entry(
              {"top-down-least-gain", 0.5, 30, Scale::kLog}, false,
              [](auto& o) -> auto& { return o.volumetric.top_down.least_gain; }),
          entry(
              {"top-down-largest-sigma", 0.05, 1, Scale::kLog}, false,
              [](auto& o) -> auto& { return o.volumetric.top_down.largest_sigma_m; })};
}

std::vector<FitParameter> of_bottom_up() {
  return {entry(
              {"bottom-up-cell", 0.03, 0.5, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.volumetric.bottom_up.cell_m; }),
          entry(
              {"bottom-up-density", 0.05, 0.95, Scale::kLinear}, true,
              [](auto& o) -> auto& { return o.volumetric.bottom_up.least_density; }),
          entry(
              {"bottom-up-largest", 0.2, 5, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.volumetric.bottom_up.largest_m; })};
}

std::vector<FitParameter> of_surface() {
  return {entry(
              {"surface-kernel", 0.2, 3, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.surface.kernel_m; }),
          entry(
              {"surface-least-kernel", 0.1, 1, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.surface.least_kernel_m; }),
          entry(
              {"surface-border", 0.05, 0.9, Scale::kLinear}, true,
              [](auto& o) -> auto& { return o.surface.border; }),
          entry(
              {"range-noise", 0.005, 0.2, Scale::kLog}, false,
              [](auto& o) -> auto& { return o.range_noise_m; })};
}

std::vector<FitParameter> of_ground() {
  return {entry(
              {"ground-spacing", 0.1, 4, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.ground.spacing_m; }),
          entry(
              {"ground-smoothness", 0.001, 10, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.ground.smoothness_m2; }),
          entry(
              {"max-residual-for-hit", 0.05, 3, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.credit.max_residual_for_hit_m; }),
          entry(
              {"range-noise", 0.005, 0.2, Scale::kLog}, false,
              [](auto& o) -> auto& { return o.range_noise_m; })};
}

std::vector<FitParameter> of_ellipsoids() {
  return {entry(
              {"tau", 0.5, 5, Scale::kLinear}, true, [](auto& o) -> auto& { return o.tau; }),
          entry(
              {"max-residual-for-hit", 0.05, 3, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.credit.max_residual_for_hit_m; }),
          entry(
              {"covariance-prior", 0, 10, Scale::kLinear}, true,
              [](auto& o) -> auto& { return o.volumetric.ellipsoid.prior_points; }),
          entry(
              {"ellipsoid-prior-hits", 0.1, 1000, Scale::kLog}, true,
              [](auto& o) -> auto& { return o.credit.ellipsoid.a; }),
          entry(
              {"ellipsoid-prior-misses", 0, 10, Scale::kLinear}, false,
              [](auto& o) -> auto& { return o.credit.ellipsoid.b; }),
          entry(
              {"free-space-below", 0, 0.5, Scale::kLinear}, false,
              [](auto& o) -> auto& { return o.free_space_below; }),
          entry(
              {"range-noise", 0.005, 0.2, Scale::kLog}, false,
              [](auto& o) -> auto& { return o.range_noise_m; })};
}

}  // namespace

std::vector<FitParameter> fit_parameters(const fit::FitOptions& options) {
  const bool refined = options.fitter == "likelihood";
  const std::string& fitter = refined ? options.start : options.fitter;
  if (fitter == "ground_mesh") return of_ground();
  if (fitter == "surface" || fitter == "rimls") return of_surface();
  std::vector<FitParameter> out = fitter == "voxel"       ? of_voxel()
                                  : fitter == "top_down"  ? of_top_down()
                                  : fitter == "bottom_up" ? of_bottom_up()
                                                          : of_hierarchical();
  const std::vector<FitParameter> shared = of_ellipsoids();
  out.insert(out.end(), shared.begin(), shared.end());
  if (refined) {
    out.push_back(entry(
        {"dropout", 0.01, 0.9, Scale::kLinear}, true,
        [](auto& o) -> auto& { return o.likelihood.dropout; }));
    out.push_back(entry(
        {"sharpness", 0.5, 5, Scale::kLog}, false,
        [](auto& o) -> auto& { return o.likelihood.sharpness; }));
  }
  return out;
}

std::vector<FitParameter> chosen_fit_parameters(const fit::FitOptions& options,
                                                std::span<const std::string> names) {
  const std::vector<FitParameter> all = fit_parameters(options);
  std::vector<FitParameter> out;
  for (const size_t k : chosen(std::vector<Parameter>(all.begin(), all.end()), names)) {
    if (all[k].usual || !names.empty()) out.push_back(all[k]);
  }
  return out;
}

}  // namespace underbrush::optimize
