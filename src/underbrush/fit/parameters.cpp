#include "underbrush/fit/parameters.hpp"

#include <algorithm>
#include <charconv>

#include "underbrush/core/check.hpp"
#include "underbrush/fit/fitters.hpp"

namespace underbrush::fit {
namespace {

using enum ParameterGroup;
using enum Scale;
using Options = FitOptions;

using enum Listed;
constexpr bool kTuned = true, kIfNamed = false;

std::vector<std::string> ground_methods() {
  return {"lower_envelope", "spherical_variance", "none"};
}

/// Converts a function of the options to the type that the table holds.
template <class F>
constexpr ParameterField at(F field) {
  using Value = std::remove_reference_t<std::invoke_result_t<F, Options&>>;
  return static_cast<Value& (*)(Options&)>(field);
}

// clang-format off
const Parameter kParameters[] = {
    {"fitter", kCommon, "", "How the model is made", at([](Options& o) -> auto& { return o.fitter; }),
     kHelp, {}, fitter_names},
    {"min-range", kCommon, "m", "Leave out nearer returns (of the own vehicle)",
     at([](Options& o) -> auto& { return o.min_range_m; }), kHelp},
    {"tile", kCommon, "m", "Side of a tile; memory grows with it",
     at([](Options& o) -> auto& { return o.tiles.tile_m; })},
    {"ranges-as-given", kCommon, "", "Learn no range offsets of the sensor's channels",
     at([](Options& o) -> auto& { return o.ranges_as_given; })},

    {"clusters-per-point", kHierarchical, "", "Number of ellipsoids per point",
     at([](Options& o) -> auto& { return o.volumetric.hierarchical.clusters_per_point; }), kHelp,
     TuningRange{0.005, 0.5, kLog, kTuned}},
    {"min-points", kHierarchical, "", "Least number of points of an ellipsoid",
     at([](Options& o) -> auto& { return o.volumetric.hierarchical.min_points; }), kHelpAll,
     TuningRange{2, 30, kWhole, kTuned}},
    {"mixture-rounds", kHierarchical, "",
     "Rounds of expectation and maximisation in which ellipsoids share the points at the borders "
     "of clusters", at([](Options& o) -> auto& { return o.volumetric.mixture.rounds; }), kReference},

    {"voxel-side", kVoxel, "m", "Side of a voxel (0.05 suits a standing scanner)",
     at([](Options& o) -> auto& { return o.volumetric.voxel.side_m; }), kHelpAll,
     TuningRange{0.05, 1, kLog, kTuned}},
    {"voxel-bounded", kVoxel, "", "A beam meets a Gaussian only within the Gaussian's own voxel",
     at([](Options& o) -> auto& { return o.volumetric.voxel.bounded; }), kReference},

    {"top-down-min-points", kTopDown, "",
     "Least number of points of each half of a cluster that is split",
     at([](Options& o) -> auto& { return o.volumetric.top_down.min_points; }), kHelpAll,
     TuningRange{3, 50, kWhole, kTuned}},

    {"bottom-up-cell", kBottomUp, "m", "Side of the cubes whose points make the first clusters",
     at([](Options& o) -> auto& { return o.volumetric.bottom_up.cell_m; }), kHelpAll,
     TuningRange{0.03, 0.5, kLog, kTuned}},

    {"surface-cell", kSurface, "m", "Cell of the marching cubes",
     at([](Options& o) -> auto& { return o.surface.cell_m; })},
    {"surface-kernel", kSurface, "m", "Radius of the kernel",
     at([](Options& o) -> auto& { return o.surface.kernel_m; }), kHelpAll,
     TuningRange{0.2, 3, kLog, kTuned}},
    {"surface-least-kernel", kSurface, "m",
     "Radius down to which the kernel is halved where points are dense",
     at([](Options& o) -> auto& { return o.surface.least_kernel_m; }), kReference,
     TuningRange{0.1, 1, kLog, kTuned}},
    {"surface-border", kSurface, "kernels",
     "Largest offset of the points' mean from the surface; the surface has a hole where it is "
     "larger",
     at([](Options& o) -> auto& { return o.surface.border; }), kReference,
     TuningRange{0.05, 0.9, kLinear, kTuned}},
    {"surface-noise", kSurface, "m",
     "Standard deviation of the simulated range; 0 = that of the residuals along the beams",
     at([](Options& o) -> auto& { return o.surface.noise_m; }), kReference},
    {"surface-carve", kSurface, "", "Leave out triangles that most beams passed",
     at([](Options& o) -> auto& { return o.surface.carve; }), kHelp},

    {"ground-method", kGround, "", "Ground segmentation",
     at([](Options& o) -> auto& { return o.segment.method; }), kHelp, {}, ground_methods},
    {"ground-spacing", kGround, "m", "Least distance of the nodes of the ground's height map",
     at([](Options& o) -> auto& { return o.ground.spacing_m; }), kHelpAll,
     TuningRange{0.1, 4, kLog, kTuned}},
    {"ground-smoothness", kGround, "m²", "Weight of bending of the ground's height map",
     at([](Options& o) -> auto& { return o.ground.smoothness_m2; }), kHelpAll,
     TuningRange{0.001, 10, kLog, kTuned}},
    {"ground-error", kGround, "m", "Largest distance of the ground mesh from the height map",
     at([](Options& o) -> auto& { return o.triangulate.max_error_m; }), kReference},

    {"tau", kEllipsoids, "", "Mahalanobis distance within which a beam meets an ellipsoid",
     at([](Options& o) -> auto& { return o.tau; }), kHelp, TuningRange{0.5, 5, kLinear, kTuned}},
    {"max-residual-for-hit", kHitProbability, "m",
     "Distance below which a triangle explains a point",
     at([](Options& o) -> auto& { return o.credit.max_residual_for_hit_m; }), kReference,
     TuningRange{0.05, 3, kLog, kTuned}},
    {"covariance-prior", kEllipsoids, "points",
     "Weight of the usual size of ellipsoids, as a prior of each covariance",
     at([](Options& o) -> auto& { return o.volumetric.ellipsoid.prior_points; }), kReference,
     TuningRange{0, 10, kLinear, kTuned}},
    {"ellipsoid-prior-hits", kEllipsoids, "", "Prior hits of an ellipsoid",
     at([](Options& o) -> auto& { return o.credit.ellipsoid.a; }), kHelpAll,
     TuningRange{0.1, 1000, kLog, kTuned}},
    {"ellipsoid-prior-misses", kEllipsoids, "", "Prior misses of an ellipsoid",
     at([](Options& o) -> auto& { return o.credit.ellipsoid.b; }), kReference,
     TuningRange{0, 10, kLinear, kIfNamed}},
    {"free-space-below", kEllipsoids, "",
     "Drop ellipsoids whose share of hits, hits / (hits + misses), is below this",
     at([](Options& o) -> auto& { return o.free_space_below; }), kHelpAll,
     TuningRange{0, 0.5, kLinear, kIfNamed}},
    {"range-noise", kCommon, "m", "The sensor's range noise",
     at([](Options& o) -> auto& { return o.range_noise_m; }), kHelp,
     TuningRange{0.005, 0.2, kLog, kIfNamed}},
    {"triangle-prior-hits", kHitProbability, "", "Prior hits of a triangle; likelihood has 10",
     at([](Options& o) -> auto& { return o.credit.triangle.a; }), kReference},
    {"triangle-prior-misses", kHitProbability, "", "Prior misses of a triangle",
     at([](Options& o) -> auto& { return o.credit.triangle.b; }), kReference},
    {"credit", kHitProbability, "", "The rule that credits elements with the hits and misses of beams",
     at([](Options& o) -> auto& { return o.credit.rule; }), kReference, {}, credit::credit_rules},

    {"start", kLikelihood, "", "The fitter to begin with, or the folder of a model",
     at([](Options& o) -> auto& { return o.start; })},
    {"rounds", kLikelihood, "", "Largest number of M-steps",
     at([](Options& o) -> auto& { return o.likelihood.rounds; })},
    {"spent-at-start", kLikelihood, "",
     "Number k of parameters fitted to the n points of each ellipsoid of the start; its variances "
     "grow by (n + k) / (n - k)",
     at([](Options& o) -> auto& { return o.likelihood.maximisation.spent_at_start; }), kReference},
    {"dropout", kLikelihood, "",
     "Assumed probability that a return is lost, so that a single miss does not make the elements "
     "that the beam met permeable",
     at([](Options& o) -> auto& { return o.likelihood.dropout; }), kHelpAll,
     TuningRange{0.01, 0.9, kLinear, kTuned}},
    {"sharpness", kLikelihood, "",
     "Exponent on the probabilities of the final model; above 1, draws have smaller errors, and the "
     "likelihood is worse", at([](Options& o) -> auto& { return o.likelihood.sharpness; }), kHelpAll,
     TuningRange{0.5, 5, kLog, kIfNamed}},
    {"keyframes", kLikelihood, "m",
     "Keep scans as range images (keyframes), at most 16 within this distance; simulated beams near "
     "them use their pixels; 0 = none",
     at([](Options& o) -> auto& { return o.keyframes.spacing_m; })},
};
// clang-format on

}  // namespace

std::span<const ParameterGroup> parameter_groups() {
  static constexpr ParameterGroup kAll[] = {kCommon,         kHierarchical, kVoxel,  kTopDown,
                                            kBottomUp,       kSurface,      kGround, kEllipsoids,
                                            kHitProbability, kLikelihood};
  return kAll;
}

std::string_view name_of(ParameterGroup group) {
  switch (group) {
    case kCommon:
      return "every fitter";
    case kHierarchical:
      return "hierarchical";
    case kVoxel:
      return "voxel";
    case kTopDown:
      return "top_down";
    case kBottomUp:
      return "bottom_up";
    case kSurface:
      return "surface, rimls";
    case kGround:
      return "ground";
    case kEllipsoids:
      return "ellipsoids";
    case kHitProbability:
      return "hit probability";
    case kLikelihood:
      return "likelihood";
  }
  return "";
}

std::span<const Parameter> parameters() { return kParameters; }

std::vector<FitterParameter> parameters_of(const FitOptions& options) {
  const Fitter& chosen = fitter_named(options.fitter);
  const Fitter& start = chosen.refines ? start_of(options) : chosen;
  const auto among = [](const std::vector<ParameterGroup>& groups, ParameterGroup group) {
    return std::find(groups.begin(), groups.end(), group) != groups.end();
  };
  std::vector<FitterParameter> out;
  for (const Parameter& p : kParameters) {
    const bool tuned = among(chosen.tuned, p.group) || among(start.tuned, p.group);
    if (!tuned && p.group != kCommon && !among(start.fixed, p.group)) continue;
    out.push_back({&p, tuned && p.tuning && p.tuning->usual});
  }
  return out;
}

double Parameter::number(const FitOptions& options) const {
  return std::visit(
      [&](const auto get) -> double {
        // A field's function takes options that may be written to, but is only read through here.
        const auto& value = get(const_cast<FitOptions&>(options));
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
          throw std::invalid_argument("fit: " + std::string(name) + " is not a number");
        } else {
          return double(value);
        }
      },
      field);
}

void Parameter::set_number(FitOptions& options, double value) const {
  std::visit(
      [&](const auto get) {
        auto& place = get(options);
        using Value = std::decay_t<decltype(place)>;
        if constexpr (std::is_same_v<Value, std::string>) {
          throw std::invalid_argument("fit: " + std::string(name) + " is not a number");
        } else {
          place = Value(value);
        }
      },
      field);
}

std::string Parameter::text(const FitOptions& options) const {
  return std::visit(
      [&](const auto get) -> std::string {
        const auto& value = get(const_cast<FitOptions&>(options));
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string>) {
          return value;
        } else if constexpr (std::is_same_v<Value, bool>) {
          return value ? "true" : "false";
        } else {
          char digits[32];
          return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
        }
      },
      field);
}

void take_all_echoes(FitOptions& options, bool keyframes_asked) {
  require(!keyframes_asked || options.keyframes.spacing_m == 0,
          "fit: keyframes hold beams, not the single echoes of all echoes");
  options.all_echoes = true;
  options.keyframes.spacing_m = 0;
}

}  // namespace underbrush::fit
