#include "underbrush/fit/parameters.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/fit/effort.hpp"
#include "underbrush/fit/fitters.hpp"

namespace underbrush::fit {
namespace {

using namespace group;
using enum Scale;
using Options = FitOptions;

using enum Listed;
constexpr bool kTuned = true, kIfNamed = false;

std::vector<std::string_view> fitter_words() {
  std::vector<std::string_view> out;
  for (const Fitter& f : fitters()) out.push_back(f.name);
  return out;
}

}  // namespace

// clang-format off
// long: the table
std::span<const Parameter> parameters() {
  static const Parameter kParameters[] = {
    {{"fitter", kCommon, "", "How the model is made", [](Options& o) -> auto& { return o.fitter; },
      -kNoLimit, kNoLimit, fitter_words()}, kHelp},
    {{"min-range", kCommon, "m",
     "Leave out nearer returns, as on the own vehicle",
     [](Options& o) -> auto& { return o.min_range_m; },
      0, 1000}, kHelp},
    {{"tile", kCommon, "m", "Side of a tile; memory grows with it",
     [](Options& o) -> auto& { return o.tiles.tile_m; },
      1, 1e6}},
    {{"ranges-as-given", kCommon, "", "Learn no range offsets of the sensor's channels",
     [](Options& o) -> auto& { return o.ranges_as_given; }}},

    {{"clusters-per-point", kHierarchical, "", "Number of ellipsoids per point",
     [](Options& o) -> auto& { return o.volumetric.hierarchical.clusters_per_point; },
      kPositive, 1}, kHelp, TuningRange{0.005, 0.5, kLog, kTuned}},
    {{"min-points", kHierarchical, "", "Least number of points of an ellipsoid",
     [](Options& o) -> auto& { return o.volumetric.hierarchical.min_points; },
      1, 1e6}, kHelpAll, TuningRange{2, 30, kWhole, kTuned}},
    {{"mixture-rounds", kHierarchical, "",
     "Rounds of expectation and maximisation in which ellipsoids share the points at the borders "
     "of clusters", [](Options& o) -> auto& { return o.volumetric.mixture.rounds; },
      0, 1000}, kReference},

    {{"voxel-side", kVoxel, "m", "Side of a voxel (0.05 suits a standing scanner)",
     [](Options& o) -> auto& { return o.volumetric.voxel.side_m; },
      0.01, 1000}, kHelpAll, TuningRange{0.05, 1, kLog, kTuned}},
    {{"voxel-bounded", kVoxel, "", "A beam meets a Gaussian only within the Gaussian's own voxel",
     [](Options& o) -> auto& { return o.volumetric.voxel.bounded; }}, kReference},

    {{"top-down-min-points", kTopDown, "",
     "Least number of points of each half of a cluster that is split",
     [](Options& o) -> auto& { return o.volumetric.top_down.min_points; },
      1, 1e6}, kReference, TuningRange{3, 50, kWhole, kTuned}},

    {{"bottom-up-cell", kBottomUp, "m", "Side of the cubes whose points make the first clusters",
     [](Options& o) -> auto& { return o.volumetric.bottom_up.cell_m; },
      0.005, 100}, kReference, TuningRange{0.03, 0.5, kLog, kTuned}},

    {{"surface-cell", kSurface, "m", "Side of the cells of the marching cubes",
     [](Options& o) -> auto& { return o.surface.cell_m; },
      0.005, 100}},
    {{"surface-kernel", kSurface, "m", "Radius of the kernel that smooths the surface",
     [](Options& o) -> auto& { return o.surface.kernel_m; },
      0.02, 100}, kReference, TuningRange{0.2, 3, kLog, kTuned}},
    {{"surface-least-kernel", kSurface, "m",
     "Radius down to which the kernel is halved where points are dense",
     [](Options& o) -> auto& { return o.surface.least_kernel_m; },
      0.02, 100}, kReference, TuningRange{0.1, 1, kLog, kTuned}},
    {{"surface-border", kSurface, "kernels",
     "Largest offset of the points' mean from the surface; the surface has a hole where the offset "
     "is larger",
     [](Options& o) -> auto& { return o.surface.border; },
      kPositive, 10}, kReference, TuningRange{0.05, 0.9, kLinear, kTuned}},
    {{"surface-noise", kSurface, "m",
     "Standard deviation of the simulated range; 0 = the standard deviation of the residuals along "
     "the beams",
     [](Options& o) -> auto& { return o.surface.noise_m; },
      0, 10}, kReference},
    {{"surface-carve", kSurface, "", "Leave out triangles that most beams passed",
     [](Options& o) -> auto& { return o.surface.carve; }}, kHelp},

    {{"ground-method", kGround, "", "Ground segmentation",
     [](Options& o) -> auto& { return o.segment.method; },
      -kNoLimit, kNoLimit, {"lower_envelope", "spherical_variance", "none"}}, kHelp},
    {{"ground-spacing", kGround, "m", "Least distance of the nodes of the ground's height map",
     [](Options& o) -> auto& { return o.ground.spacing_m; },
      0.05, 1000}, kHelpAll, TuningRange{0.1, 4, kLog, kTuned}},
    {{"ground-smoothness", kGround, "m²", "Weight of bending of the ground's height map",
     [](Options& o) -> auto& { return o.ground.smoothness_m2; },
      kPositive, 1e6}, kReference, TuningRange{0.001, 10, kLog, kTuned}},
    {{"ground-error", kGround, "m", "Largest distance of the ground mesh from the height map",
     [](Options& o) -> auto& { return o.triangulate.max_error_m; },
      0, 100}, kReference},

    {{"tau", kEllipsoids, "", "Mahalanobis distance within which a beam meets an ellipsoid",
     [](Options& o) -> auto& { return o.tau; },
      kPositive, 20}, kHelpAll, TuningRange{0.5, 5, kLinear, kTuned}},
    {{"max-residual-for-hit", kHitProbability, "m",
     "Distance below which a triangle explains a point",
     [](Options& o) -> auto& { return o.credit.max_residual_for_hit_m; },
      0, 100}, kReference, TuningRange{0.05, 3, kLog, kTuned}},
    {{"covariance-prior", kEllipsoids, "points",
     "Weight of the usual size of ellipsoids, as a prior of each covariance",
     [](Options& o) -> auto& { return o.volumetric.ellipsoid.prior_points; },
      0, 1e6}, kReference, TuningRange{0, 10, kLinear, kTuned}},
    {{"ellipsoid-prior-hits", kEllipsoids, "", "Prior hits of an ellipsoid",
     [](Options& o) -> auto& { return o.credit.ellipsoid.a; },
      0, 1e6}, kHelpAll, TuningRange{0, 20, kLinear, kTuned}},
    {{"ellipsoid-prior-misses", kEllipsoids, "", "Prior misses of an ellipsoid",
     [](Options& o) -> auto& { return o.credit.ellipsoid.b; },
      0, 1e6}, kReference, TuningRange{0, 10, kLinear, kIfNamed}},
    {{"free-space-below", kEllipsoids, "",
     "Drop ellipsoids whose hits came within a short time and whose share of hits, hits / (hits + "
     "misses), is below this",
     [](Options& o) -> auto& { return o.free_space_below; },
      0, 1}, kHelpAll, TuningRange{0, 0.5, kLinear, kIfNamed}},
    {{"range-noise", kCommon, "m", "The sensor's range noise, at most",
     [](Options& o) -> auto& { return o.range_noise_m; },
      1e-5, 2}, kHelp, TuningRange{0.005, 0.2, kLog, kIfNamed}},
    {{"triangle-prior-hits", kHitProbability, "", "Prior hits of a triangle; likelihood has 10",
     [](Options& o) -> auto& { return o.credit.triangle.a; },
      0, 1e6}, kReference},
    {{"triangle-prior-misses", kHitProbability, "", "Prior misses of a triangle",
     [](Options& o) -> auto& { return o.credit.triangle.b; },
      0, 1e6}, kReference},
    {{"credit", kHitProbability, "", "The rule that credits elements with the hits and misses of beams",
     [](Options& o) -> auto& { return o.credit.rule; },
      -kNoLimit, kNoLimit, credit::credit_rules()}, kReference},

    {{"effort", kLikelihood, "",
     "How much of a long log is used",
     [](Options& o) -> auto& { return o.effort; },
      -kNoLimit, kNoLimit, effort_names()}, kHelp},
    {{"start", kLikelihood, "", "The fitter to begin with, or the folder of a model",
     [](Options& o) -> auto& { return o.start; }}},
    {{"rounds", kLikelihood, "", "Largest number of M-steps",
     [](Options& o) -> auto& { return o.likelihood.rounds; },
      0, 10000}},
    {{"spent-at-start", kLikelihood, "",
     "Number k of parameters fitted to the n points of each ellipsoid of the start; its variances "
     "grow by (n + k) / (n - k)",
     [](Options& o) -> auto& { return o.likelihood.maximisation.spent_at_start; },
      0, 1000}, kReference},
    {{"dropout", kLikelihood, "",
     "Assumed probability that a return is lost; the greater it is, the more misses count as lost "
     "returns and not as passes through elements",
     [](Options& o) -> auto& { return o.likelihood.dropout; },
      kPositive, 0.9}, kHelpAll, TuningRange{0.0001, 0.1, kLog, kIfNamed}},
    {{"sharpness", kLikelihood, "",
     "How certain the outcomes of the final model are: above 1, draws have smaller errors and the "
     "likelihood is worse; 1 = as fitted", [](Options& o) -> auto& { return o.likelihood.sharpness; },
      0.1, 10}, kHelpAll, TuningRange{0.5, 5, kLog, kIfNamed}},
    {{"keyframes", kLikelihood, "m",
     "Keep scans as range images (keyframes), at most 16 within this distance; simulated beams near "
     "them use their pixels; 0 = none",
     [](Options& o) -> auto& { return o.keyframes.spacing_m; },
      0, 1e6}},
    {{"unknown-cell", kLikelihood, "m",
     "Side of the cells of the map of observed space; in unknown space, which no beam crossed, "
     "simulated beams end with a density that is learnt from the log; 0 = unknown space is empty",
     [](Options& o) -> auto& { return o.unknown_cell_m; },
      0, 100}, kHelpAll},
  };
  return kParameters;
}
// clang-format on

std::vector<std::string> fitter_names() {
  const std::vector<std::string_view> words = fitter_words();
  return {words.begin(), words.end()};
}

std::vector<FitterParameter> parameters_of(const FitOptions& options) {
  const Fitter& chosen = fitter_named(options.fitter);
  const Fitter& start = chosen.refines ? start_of(options) : chosen;
  const auto among = [](const std::vector<std::string_view>& groups, std::string_view group) {
    return std::find(groups.begin(), groups.end(), group) != groups.end();
  };
  std::vector<FitterParameter> out;
  for (const Parameter& p : parameters()) {
    const bool tuned = among(chosen.tuned, p.group) || among(start.tuned, p.group);
    if (!tuned && p.group != kCommon && !among(start.fixed, p.group)) continue;
    out.push_back({&p, tuned && p.tuning && p.tuning->usual});
  }
  return out;
}

void take_all_echoes(FitOptions& options, bool keyframes_asked) {
  require(!keyframes_asked || options.keyframes.spacing_m == 0,
          "fit: keyframes hold beams, not the single echoes of all echoes");
  options.all_echoes = true;
  options.keyframes.spacing_m = 0;
}

}  // namespace underbrush::fit
