#include "underbrush/fit/likelihood.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::fit {
namespace {

using Progress = std::function<void(std::string_view, size_t, size_t)>;

/// The best model so far, and trials of other models against it.
class ModelSearch {
 public:
  ModelSearch(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
              const Progress& progress)
      : source_(source), options_(options), progress_(progress) {
    soft_.miss = options.dropout;
    best_.model = std::make_unique<elements::Model>(start);
    best_.seen = pass(*best_.model, "start");
    note("start", best_, true);
  }

  const elements::Model& model() const { return *best_.model; }
  const ElementSums& sums() const { return best_.seen.sums; }
  Refined result() {
    report_.training_beams = best_.seen.training_beams;
    report_.held_out_beams = best_.seen.held_out_beams;
    report_.stray_hits = best_.seen.stray_hits;
    return {options_.sharpness == 1 ? std::move(*best_.model)
                                    : sharpened(*best_.model, options_.sharpness),
            std::move(report_)};
  }

  /// Keeps the candidate if it explains the held-out beams better, at once or after up to `m_steps`
  /// M-steps.
  bool attempt(const char* name, elements::Model candidate, int m_steps) {
    for (;; --m_steps) {
      State trial;
      trial.model = std::make_unique<elements::Model>(std::move(candidate));
      trial.seen = pass(*trial.model, name);
      const bool better = trial.seen.held_out_nll < best_.seen.held_out_nll - options_.least_gain;
      note(name, trial, better);
      if (better) {
        best_ = std::move(trial);
        soft_.hit = std::clamp(best_.seen.stray_hits, 1e-4, 0.2);
        return true;
      }
      if (m_steps == 0) return false;
      candidate = maximised(*trial.model, trial.seen.sums, options_.maximisation, 1);
    }
  }

 private:
  struct State {
    // on the heap, so that the sums' pointer to it stays valid
    std::unique_ptr<elements::Model> model;
    Expectation seen;
  };

  Expectation pass(const elements::Model& model, const char* name) {
    return expect(model, source_, options_.held_out, soft_, [&](size_t done, size_t total) {
      if (progress_) progress_(name, done, total);
    });
  }

  void note(const char* name, const State& s, bool accepted) {
    report_.steps.push_back(
        {name, s.model->size(), s.seen.training_nll, s.seen.held_out_nll, accepted});
  }

  BeamSource& source_;
  const LikelihoodOptions& options_;
  const Progress& progress_;
  trace::OutlierShares soft_;
  State best_;
  LikelihoodReport report_;
};

}  // namespace

Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const Progress& progress) {
  require(start.voxel_m == 0, "likelihood: ellipsoids bounded by voxels cannot be refined");
  require(options.held_out.one_in > 1, "likelihood: some of the beams must be held out");
  require(options.dropout > 0 && options.dropout < 0.9, "likelihood: dropout must be in (0, 0.9)");
  require(options.sharpness >= 0.1 && options.sharpness <= 10,
          "likelihood: sharpness must be in [0.1, 10]");
  ModelSearch search(start, source, options, progress);
  const MaximisationOptions& m = options.maximisation;
  search.attempt("density", with_densities(search.model(), options.range_noise_m), 2);
  const auto rearrange = [&](int m_steps) {
    return search.attempt(
        "rearrange", rearranged(search.model(), search.sums(), options.rearrangement), m_steps);
  };
  // In an M-step, redundant ellipsoids of a few beams each would fit those beams' noise, so
  // rearrangements come first.
  for (int round = 0; round < options.rounds && rearrange(2); ++round) {
  }
  double stride = 0.5;
  for (int round = 0; round < options.rounds; ++round) {
    if (round % 3 == 2 && rearrange(1)) continue;
    if (search.attempt("maximise", maximised(search.model(), search.sums(), m, stride), 0))
      continue;
    if ((stride *= 0.3) < 0.05) break;
  }
  return search.result();
}

}  // namespace underbrush::fit
