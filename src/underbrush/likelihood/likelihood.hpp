/// \file
/// This file has the fitter `likelihood`, which refines a model by expectation–maximisation on the
/// ray model.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "underbrush/likelihood/expectation.hpp"
#include "underbrush/likelihood/maximisation.hpp"

namespace underbrush {
/// The refinement of a model by the likelihood of the beams of a log.
namespace likelihood {

/// The memory for the training beams of a refinement, bytes.
inline constexpr size_t kListBytes = size_t(1) << 29;

/// The training beams of the steps of a long log, unless others are asked for.
inline constexpr credit::BeamShare kUsualShares[] = {{0, 2}, {2, 4}, {4, 6}, {6, 8}, {0, 8}};

/// The options of `refine`.
struct LikelihoodOptions {
  credit::HeldOut held_out;
  int rounds = 5;  ///< Largest number of M-steps.
  /// The training beams of the steps of a long log (`share_of_round`); what they refer to must
  /// outlive the options.
  std::span<const credit::BeamShare> shares = kUsualShares;
  /// A step is kept if it lowers the held-out −log f by this, nats a beam.
  double least_gain = 0.0005;
  /// The probability ε_m that a return was lost, as the expectation step uses it. It must be small
  /// against the share of beams that pass the densest matter: where it is not, passes count as lost
  /// returns, and matter that beams pass last becomes opaque. See docs/explanation/likelihood.md.
  double dropout = 0.001;
  /// The exponent γ of `sharpened`, applied to the final model; 1 leaves it as it is. Above 1, a
  /// simulated range lies nearer to the measured one, while likelihood and CRPS get worse.
  double sharpness = 1;
  double range_noise_m = 0.02;  ///< σ of the sensor's range, m.
  MaximisationOptions maximisation;
};

/// A step that was tried.
struct LikelihoodStep {
  std::string name;  ///< `start`, `maximise` or `calibrate`.
  size_t elements = 0;
  /// Mean −log f over the training beams, nats, as in `metrics::score`; known only of models from
  /// which a further step was tried.
  std::optional<double> training_nll;
  double held_out_nll = 0;  ///< Mean −log f over the held-out beams, nats.
  bool accepted = false;
};

/// The report of a refinement.
struct LikelihoodReport {
  size_t training_beams = 0, held_out_beams = 0;
  size_t held_out_hits = 0;  ///< Number of the held-out beams that returned.
  /// Estimated share of returns that no element explains, in the last pass over training beams.
  double stray_hits = 0;
  std::vector<LikelihoodStep> steps;
};

/// A refined model and its report.
struct Refined {
  elements::Model model;
  LikelihoodReport report;
};

/// A model, and the world in which beams are traced through it.
struct TracedModel {
  explicit TracedModel(elements::Model m) : model(std::move(m)), world(model) {}
  elements::Model model;
  trace::World world;
};

/// The limits of a refinement.
struct RefinementLimits {
  /// Whether each element may change; empty if all may. Beams meet the others, too, but these stay
  /// as they are.
  std::vector<bool> moving;
  /// m²; the least covariance of each ellipsoid (`cluster::open_covariances`), or empty. In each
  /// direction, the ellipsoid's variance less that of the least extent is at least this.
  std::vector<Eigen::Matrix3f> open;
};

/// A refinement between two passes over the training beams.
struct Refinement {
  std::shared_ptr<TracedModel> best;  ///< The best model so far.
  double held_out_nll = 0;            ///< Mean −log f of its held-out beams, nats.
  trace::OutlierShares soft;          ///< The outliers under which credit is given.
  LikelihoodReport report;
  size_t step = 0;      ///< The place of the model in the steps of the report.
  int round = 0;        ///< M-steps tried so far.
  double stride = 0.8;  ///< The length of the next step, below 1 because neighbours move at once.

  /// The share of the training beams of which the next M-step needs the sums under the model;
  /// nothing where no M-step follows.
  std::optional<credit::BeamShare> wanted(const LikelihoodOptions& options) const;
};

/// The steps of `refine`, each a function of the refinement so far, so that passes may be made
/// elsewhere: sums of parts of the training beams (`pass_over_training`), added, are those of all.
class Refiner {
 public:
  /// `start` is the model that the refinement begins with. It, `beams` and `options` must outlive
  /// the refiner. Of `beams` the held-out ones and the number of training beams count. Throws as
  /// `refine` does.
  Refiner(const elements::Model& start, const ListedBeams& beams, const LikelihoodOptions& options,
          RefinementLimits limits = {});
  ~Refiner();

  /// Begins with the start with densities.
  Refinement begin();
  /// Tries M-steps from the sums of the share that `wanted` names, until other sums are wanted.
  void maximise(Refinement& r, const Expectation& seen);
  /// Corrects the densities by the held-out beams, and returns the final model.
  Refined finish(Refinement r);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The share of the training beams from which a round takes its M-step. The first steps move all
/// elements far and need only a rough estimate, so of a long log (`kLongLog`) each takes its share
/// of `options.shares`, and further ones take the last. With fewer rounds than shares, only the
/// last shares are used. Of a shorter log, all beams are used.
credit::BeamShare share_of_round(size_t beams, int round, const LikelihoodOptions& options);

/// Refines a model by steps. A step is kept only if it raises the likelihood of the held-out beams.
/// The steps are:
///
/// 1. hit probabilities are turned into densities (`with_densities`);
/// 2. M-steps (`maximised`) follow, from shares of the beams (`share_of_round`);
/// 3. the held-out beams correct the densities (`calibrated`).
///
/// The final ellipsoids are `sharpened`.
///
/// The beams are read and searched anew for each step that goes on from a model; the held-out
/// beams, on which its acceptance is based, stay in memory. The result has the same bits for any
/// number of threads and any order of the beams. `progress(stage, done, total)` may be empty.
/// Throws `std::invalid_argument` for ellipsoids bounded by voxels, because their means would leave
/// the voxels, and for options or limits out of range.
Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const std::function<void(std::string_view, size_t, size_t)>& progress = {},
               RefinementLimits limits = {});

}  // namespace likelihood
}  // namespace underbrush
