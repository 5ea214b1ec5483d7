#include "underbrush/fit/likelihood.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

using Progress = std::function<void(std::string_view, size_t, size_t)>;

/// The memory for lists of meetings, bytes.
constexpr size_t kListBytes = size_t(1) << 30;
/// The bounds in which ellipsoids may move until the next search, as a multiple of their extents.
constexpr double kBounds = 1.5;
/// A search follows once more than this share of the ellipsoids is held back by the bounds, but not
/// before so many M-steps: it takes as long as two of them.
constexpr double kHeldBack = 0.1;
constexpr int kStepsOfSearch = 3;
/// The length of M-steps, shorter than 1 because neighbours move at once.
constexpr double kStride = 0.8;

/// The best model so far, and trials of other models against it.
class ModelSearch {
 public:
  ModelSearch(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
              const Progress& progress, const std::vector<bool>& moving)
      : source_(source), options_(options), progress_(progress), moving_(moving) {
    soft_.miss = options.dropout;
    best_.model = with_densities(start, options.range_noise_m, options.maximisation);
    search(best_);
    pass(best_, "start");
    note("start", best_, true);
  }

  Refined result() {
    report_.training_beams = best_.seen.training_beams;
    report_.held_out_beams = best_.seen.held_out_beams;
    report_.held_out_hits = best_.seen.held_out_hits;
    report_.stray_hits = best_.seen.stray_hits;
    return {options_.sharpness == 1 ? std::move(best_.model)
                                    : sharpened(best_.model, options_.sharpness),
            std::move(report_)};
  }

  /// Keeps the rearranged model if it explains the held-out beams better, at once or after up to
  /// `m_steps` M-steps.
  bool rearrange(int m_steps) {
    State trial;
    Rearranged after = rearranged(best_.model, best_.seen.sums, options_.rearrangement);
    trial.lists = std::make_shared<Meetings>(*best_.lists, after);
    trial.model = std::move(after.model);
    pass(trial, "rearrange");
    while (!accept("rearrange", trial)) {
      if (m_steps-- == 0) return false;
      trial.model = step_of(trial, 1);
      pass(trial, "rearrange");
    }
    return true;
  }

  /// Keeps the model after an M-step if it explains the held-out beams better.
  bool maximise(double stride) {
    State trial;
    trial.model = step_of(best_, stride);
    const double most = kHeldBack * double(best_.model.ellipsoids.size());
    if (steps_ >= kStepsOfSearch && double(held_back_) > most) {
      search(best_);
      trial.model = step_of(best_, stride);
      steps_ = 0;
    }
    ++steps_;
    trial.lists = best_.lists;
    pass(trial, "maximise");
    return accept("maximise", trial);
  }

 private:
  /// A model, the lists in whose bounds it is, and what a pass has seen of it.
  struct State {
    elements::Model model;
    std::shared_ptr<const Meetings> lists;
    Expectation seen;
  };

  void search(State& s) const {
    s.lists.reset();
    s.lists = std::make_shared<Meetings>(s.model, kBounds, source_, options_.held_out, kListBytes);
  }

  void pass(State& s, const char* name) const {
    s.seen = expect(s.model, *s.lists, soft_, [&](size_t done, size_t total) {
      if (progress_) progress_(name, done, total);
    });
  }

  /// Takes an M-step, of which each ellipsoid goes as far as the bounds of the lists allow.
  elements::Model step_of(const State& s, double stride) {
    elements::Model next = maximised(s.model, s.seen.sums, options_.maximisation, stride);
    if (!moving_.empty()) keep_others(s.model, next);
    held_back_ = s.lists->keep_within_bounds(s.model, next);
    return next;
  }

  /// Puts all elements back that may not move.
  void keep_others(const elements::Model& now, elements::Model& next) const {
    next.ground = now.ground;
    next.surface = now.surface;
    for (size_t k = 0; k < moving_.size(); ++k) {
      if (!moving_[k]) next.ellipsoids[k] = now.ellipsoids[k];
    }
  }

  bool accept(const char* name, State& trial) {
    const bool better = trial.seen.held_out_nll < best_.seen.held_out_nll - options_.least_gain;
    note(name, trial, better);
    if (!better) return false;
    best_ = std::move(trial);
    soft_.hit = std::clamp(best_.seen.stray_hits, 1e-4, 0.2);
    return true;
  }

  void note(const char* name, const State& s, bool accepted) {
    report_.steps.push_back(
        {name, s.model.size(), s.seen.training_nll, s.seen.held_out_nll, accepted});
  }

  BeamSource& source_;
  const LikelihoodOptions& options_;
  const Progress& progress_;
  trace::OutlierShares soft_;
  const std::vector<bool>& moving_;
  size_t held_back_ = 0;
  int steps_ = 0;  // since the search
  State best_;
  LikelihoodReport report_;
};

}  // namespace

Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const Progress& progress, const std::vector<bool>& moving) {
  require(start.voxel_m == 0, "likelihood: ellipsoids bounded by voxels cannot be refined");
  require(options.held_out.one_in > 1, "likelihood: some of the beams must be held out");
  require(options.dropout > 0 && options.dropout < 0.9, "likelihood: dropout must be in (0, 0.9)");
  require(options.maximisation.spent_at_start >= 0,
          "likelihood: the start's parameters must not be negative");
  require(options.sharpness >= 0.1 && options.sharpness <= 10,
          "likelihood: sharpness must be in [0.1, 10]");
  require(moving.empty() || moving.size() == start.ellipsoids.size(),
          "likelihood: `moving` must have an entry for each ellipsoid");
  ModelSearch search(start, source, options, progress, moving);
  // In an M-step, redundant ellipsoids of a few beams each would fit those beams' noise, so
  // rearrangements come first.
  const int rearrangements = moving.empty() ? options.rearrangements : 0;
  for (int k = 0; k < rearrangements && search.rearrange(1); ++k) {
  }
  double stride = kStride;
  for (int round = 0; round < options.rounds; ++round) {
    if (search.maximise(stride)) continue;
    if ((stride *= 0.3) < 0.05) break;
  }
  return search.result();
}

}  // namespace underbrush::fit
