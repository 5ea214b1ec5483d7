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

constexpr bool kUsual = true, kRare = false;
constexpr bool kTuned = true, kIfNamed = false;

std::vector<std::string> top_down_stops() { return {"points", "range_likelihood"}; }
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
     kUsual, {}, fitter_names},
    {"min-range", kCommon, "m", "Leave out nearer returns (of the own vehicle)",
     at([](Options& o) -> auto& { return o.min_range_m; }), kUsual},
    {"tile", kCommon, "m", "Side of a tile; memory grows with it",
     at([](Options& o) -> auto& { return o.tiles.tile_m; })},
    {"ranges-as-given", kCommon, "", "Learn no range offsets of the sensor's channels",
     at([](Options& o) -> auto& { return o.ranges_as_given; })},

    {"clusters-per-point", kHierarchical, "", "Number of ellipsoids per point",
     at([](Options& o) -> auto& { return o.volumetric.hierarchical.clusters_per_point; }), kUsual,
     TuningRange{0.005, 0.5, kLog, kTuned}},
    {"min-points", kHierarchical, "", "Fewest points of an ellipsoid",
     at([](Options& o) -> auto& { return o.volumetric.hierarchical.min_points; }), kRare,
     TuningRange{2, 30, kWhole, kTuned}},
    {"mixture-rounds", kHierarchical, "",
     "Rounds of expectation and maximisation in which ellipsoids share the points at the borders "
     "of clusters", at([](Options& o) -> auto& { return o.volumetric.mixture.rounds; })},

    {"voxel-side", kVoxel, "m", "Side of a voxel (0.05 suits a standing scanner)",
     at([](Options& o) -> auto& { return o.volumetric.voxel.side_m; }), kRare,
     TuningRange{0.05, 1, kLog, kTuned}},
    {"voxel-bounded", kVoxel, "", "A beam meets a Gaussian only within the Gaussian's own voxel",
     at([](Options& o) -> auto& { return o.volumetric.voxel.bounded; })},

    {"top-down-stop", kTopDown, "", "The rule that leaves a cluster whole",
     at([](Options& o) -> auto& { return o.volumetric.top_down.stop; }), kRare, {}, top_down_stops},
    {"top-down-min-points", kTopDown, "", "Fewest points of a half",
     at([](Options& o) -> auto& { return o.volumetric.top_down.min_points; }), kRare,
     TuningRange{3, 50, kWhole, kTuned}},
    {"top-down-least-gain", kTopDown, "nats", "range_likelihood: what a split must gain",
     at([](Options& o) -> auto& { return o.volumetric.top_down.least_gain; }), kRare,
     TuningRange{0.5, 30, kLog, kIfNamed}},
    {"top-down-largest-sigma", kTopDown, "m",
     "range_likelihood: clusters of a larger standard deviation are split in any case",
     at([](Options& o) -> auto& { return o.volumetric.top_down.largest_sigma_m; }), kRare,
     TuningRange{0.05, 1, kLog, kIfNamed}},

    {"bottom-up-cell", kBottomUp, "m", "Side of the first, small clusters",
     at([](Options& o) -> auto& { return o.volumetric.bottom_up.cell_m; }), kRare,
     TuningRange{0.03, 0.5, kLog, kTuned}},
    {"bottom-up-density", kBottomUp, "",
     "Share of its parts' density that a merged ellipsoid must keep",
     at([](Options& o) -> auto& { return o.volumetric.bottom_up.least_density; }), kRare,
     TuningRange{0.05, 0.95, kLinear, kTuned}},
    {"bottom-up-largest", kBottomUp, "m", "Greatest length of a merged ellipsoid",
     at([](Options& o) -> auto& { return o.volumetric.bottom_up.largest_m; }), kRare,
     TuningRange{0.2, 5, kLog, kTuned}},

    {"surface-cell", kSurface, "m", "Cell of the marching cubes",
     at([](Options& o) -> auto& { return o.surface.cell_m; })},
    {"surface-kernel", kSurface, "m", "Radius of the kernel",
     at([](Options& o) -> auto& { return o.surface.kernel_m; }), kRare,
     TuningRange{0.2, 3, kLog, kTuned}},
    {"surface-least-kernel", kSurface, "m",
     "Radius down to which the kernel is halved where points are dense",
     at([](Options& o) -> auto& { return o.surface.least_kernel_m; }), kRare,
     TuningRange{0.1, 1, kLog, kTuned}},
    {"surface-border", kSurface, "kernels",
     "Largest offset of the points' mean from the surface; beyond it is a hole",
     at([](Options& o) -> auto& { return o.surface.border; }), kRare,
     TuningRange{0.05, 0.9, kLinear, kTuned}},
    {"surface-noise", kSurface, "m",
     "σ of the simulated range; 0 = as the residuals along the beams are",
     at([](Options& o) -> auto& { return o.surface.noise_m; })},
    {"surface-carve", kSurface, "", "Leave out triangles that most beams passed",
     at([](Options& o) -> auto& { return o.surface.carve; }), kUsual},

    {"ground-method", kGround, "", "Ground segmentation",
     at([](Options& o) -> auto& { return o.segment.method; }), kUsual, {}, ground_methods},
    {"ground-spacing", kGround, "m", "Least distance of the nodes of the ground's height map",
     at([](Options& o) -> auto& { return o.ground.spacing_m; }), kRare,
     TuningRange{0.1, 4, kLog, kTuned}},
    {"ground-smoothness", kGround, "m²", "Weight of bending of the ground's height map",
     at([](Options& o) -> auto& { return o.ground.smoothness_m2; }), kRare,
     TuningRange{0.001, 10, kLog, kTuned}},
    {"ground-error", kGround, "m", "Largest distance of the ground mesh from the height map",
     at([](Options& o) -> auto& { return o.triangulate.max_error_m; })},

    {"tau", kEllipsoids, "", "Mahalanobis distance within which a beam meets an ellipsoid",
     at([](Options& o) -> auto& { return o.tau; }), kUsual, TuningRange{0.5, 5, kLinear, kTuned}},
    {"max-residual-for-hit", kHitProbability, "m", "A triangle explains a point nearer than this",
     at([](Options& o) -> auto& { return o.credit.max_residual_for_hit_m; }), kRare,
     TuningRange{0.05, 3, kLog, kTuned}},
    {"covariance-prior", kEllipsoids, "points",
     "Points' worth of the usual size mixed into each ellipsoid's covariance",
     at([](Options& o) -> auto& { return o.volumetric.ellipsoid.prior_points; }), kRare,
     TuningRange{0, 10, kLinear, kTuned}},
    {"ellipsoid-prior-hits", kEllipsoids, "", "Prior hits of an ellipsoid",
     at([](Options& o) -> auto& { return o.credit.ellipsoid.a; }), kRare,
     TuningRange{0.1, 1000, kLog, kTuned}},
    {"ellipsoid-prior-misses", kEllipsoids, "", "Prior misses of an ellipsoid",
     at([](Options& o) -> auto& { return o.credit.ellipsoid.b; }), kRare,
     TuningRange{0, 10, kLinear, kIfNamed}},
    {"free-space-below", kEllipsoids, "",
     "Drop ellipsoids with hits / (hits + misses) below this: nothing stands there",
     at([](Options& o) -> auto& { return o.free_space_below; }), kRare,
     TuningRange{0, 0.5, kLinear, kIfNamed}},
    {"range-noise", kCommon, "m", "The sensor's range noise",
     at([](Options& o) -> auto& { return o.range_noise_m; }), kUsual,
     TuningRange{0.005, 0.2, kLog, kIfNamed}},
    {"triangle-prior-hits", kHitProbability, "", "Prior hits of a triangle; likelihood has 10",
     at([](Options& o) -> auto& { return o.credit.triangle.a; })},
    {"triangle-prior-misses", kHitProbability, "", "Prior misses of a triangle",
     at([](Options& o) -> auto& { return o.credit.triangle.b; })},
    {"credit", kHitProbability, "", "The elements that a beam is evidence of",
     at([](Options& o) -> auto& { return o.credit.rule; }), kRare, {}, credit::credit_rules},
    {"credit-tau", kHitProbability, "",
     "credit mahalanobis: greatest distance of a beam from an ellipsoid; at most tau counts",
     at([](Options& o) -> auto& { return o.credit.tau_m; })},
    {"hit-estimator", kHitProbability, "", "The estimate of p from an ellipsoid's hits and misses",
     at([](Options& o) -> auto& { return o.credit.estimator; }), kRare, {}, credit::hit_estimators},

    {"start", kLikelihood, "", "The fitter to begin with, or the folder of a model",
     at([](Options& o) -> auto& { return o.start; })},
    {"rounds", kLikelihood, "", "Most M-steps",
     at([](Options& o) -> auto& { return o.likelihood.rounds; })},
    {"rearrangements", kLikelihood, "", "Most times that ellipsoids are merged and split before",
     at([](Options& o) -> auto& { return o.likelihood.rearrangements; })},
    {"spent-at-start", kLikelihood, "",
     "Ellipsoids of the start grow as if their n points had been fitted with k parameters: their "
     "variances by (n + k) / (n - k)",
     at([](Options& o) -> auto& { return o.likelihood.maximisation.spent_at_start; })},
    {"held-out", kLikelihood, "",
     "One group of beams in so many judges the steps and is not learnt from",
     at([](Options& o) -> auto& { return o.likelihood.held_out.one_in; })},
    {"dropout", kLikelihood, "",
     "How readily a lone miss is taken as a lost return, not as a way through",
     at([](Options& o) -> auto& { return o.likelihood.dropout; }), kRare,
     TuningRange{0.01, 0.9, kLinear, kTuned}},
    {"sharpness", kLikelihood, "",
     "How much more decided than the likeliest model: above 1 for smaller errors of a draw, at the "
     "cost of likelihood", at([](Options& o) -> auto& { return o.likelihood.sharpness; }), kRare,
     TuningRange{0.5, 5, kLog, kIfNamed}},
    {"keyframes", kLikelihood, "m",
     "Remember scans as range images, at most 16 within this distance; simulations near them answer "
     "likewise (0: none)",
     at([](Options& o) -> auto& { return o.keyframes.spacing_m; })},
    {"merge-cost", kLikelihood, "nats",
     "Most that merging two ellipsoids may cost their points; 0: merge where it costs nothing",
     at([](Options& o) -> auto& { return o.likelihood.rearrangement.largest_cost; })},
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

}  // namespace underbrush::fit
