#include "underbrush/likelihood/likelihood.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::likelihood {
namespace {

/// Puts all elements back that may not move, and what the triangles of a mesh share.
void keep_others(const std::vector<bool>& moving, const elements::Model& now,
                 elements::Model& next) {
  size_t element = 0;
  for (auto mesh : {&elements::Model::ground, &elements::Model::surface}) {
    const elements::TriangleMesh& before = now.*mesh;
    elements::TriangleMesh& after = next.*mesh;
    after.range_sigma_m = before.range_sigma_m;
    after.roughness_m = before.roughness_m;
    for (uint32_t t = 0; t < before.size(); ++t, ++element) {
      if (moving[element]) continue;
      after.hit[t] = before.hit[t];
      if (!after.roughness.empty()) after.roughness[t] = float(before.roughness_at(t));
    }
  }
  for (size_t k = 0; k < now.ellipsoids.size(); ++k, ++element) {
    if (!moving[element]) next.ellipsoids[k] = now.ellipsoids[k];
  }
}

void check(const elements::Model& start, const LikelihoodOptions& options,
           const RefinementLimits& limits) {
  require(start.voxel_m == 0, "likelihood: ellipsoids bounded by voxels cannot be refined");
  require(options.held_out.one_in > 1, "likelihood: some of the beams must be held out");
  require(!options.shares.empty(), "likelihood: the steps have no share of the beams");
  require(options.dropout > 0 && options.dropout <= 0.9, "likelihood: dropout must be in (0, 0.9]");
  require(options.maximisation.spent_at_start >= 0,
          "likelihood: the start's parameters must not be negative");
  require(options.sharpness >= 0.1 && options.sharpness <= 10,
          "likelihood: sharpness must be in [0.1, 10]");
  require(limits.moving.empty() || limits.moving.size() == start.size(),
          "likelihood: `moving` must have an entry for each element");
  require(limits.open.empty() || limits.open.size() == start.ellipsoids.size(),
          "likelihood: `open` must have an entry for each ellipsoid");
}

void note(const char* name, const elements::Model& model, double held_out_nll, bool accepted,
          LikelihoodReport& report) {
  report.steps.push_back({name, model.size(), {}, held_out_nll, accepted});
}

}  // namespace

struct Refiner::State {
  const elements::Model& start;
  const ListedBeams& beams;
  const LikelihoodOptions& options;
  RefinementLimits limits;
  Neighbours neighbours;

  /// Takes a model for the best one if it explains the held-out beams better.
  bool accept(const char* name, elements::Model model, Refinement& r) const {
    auto trial = std::make_shared<TracedModel>(std::move(model));
    const double nll = validation_nll(trial->world, beams);
    const bool better = nll < r.held_out_nll - options.least_gain;
    note(name, trial->model, nll, better, r.report);
    if (!better) return false;
    r.step = r.report.steps.size() - 1;
    r.held_out_nll = nll;
    r.best = std::move(trial);
    return true;
  }
};

Refiner::Refiner(const elements::Model& start, const ListedBeams& beams,
                 const LikelihoodOptions& options, RefinementLimits limits) {
  check(start, options, limits);
  state_ = std::make_unique<State>(
      State{start, beams, options, std::move(limits), Neighbours(start.ellipsoids)});
}

Refiner::~Refiner() = default;

Refinement Refiner::begin() {
  const State& s = *state_;
  Refinement r;
  r.best = std::make_shared<TracedModel>(
      with_densities(s.start, s.options.range_noise_m, s.options.maximisation));
  r.held_out_nll = validation_nll(r.best->world, s.beams);
  r.soft.miss = s.options.dropout;
  note("start", r.best->model, r.held_out_nll, true, r.report);
  r.report.training_beams = s.beams.training_beams();
  r.report.held_out_beams = s.beams.held_out().size();
  r.report.held_out_hits = s.beams.held_out_hits();
  return r;
}

std::optional<credit::BeamShare> Refinement::wanted(const LikelihoodOptions& options) const {
  if (round >= options.rounds || stride < 0.05) return {};
  return share_of_round(report.training_beams, round, options);
}

void Refiner::maximise(Refinement& r, const Expectation& seen) {
  const State& s = *state_;
  const auto share = r.wanted(s.options);
  r.report.steps[r.step].training_nll = seen.nll;
  r.report.stray_hits = seen.stray_hits;
  // The start leaves more unexplained than any model after it.
  if (r.step > 0) r.soft.hit = std::clamp(seen.stray_hits, 1e-4, 0.2);
  bool better = false;
  while (!better && share && r.wanted(s.options) == share) {
    elements::Model next = maximised(r.best->model, seen.sums, s.neighbours, s.options.maximisation,
                                     r.stride, s.limits.open);
    if (!s.limits.moving.empty()) keep_others(s.limits.moving, r.best->model, next);
    better = s.accept("maximise", std::move(next), r);
    ++r.round;
    if (!better && share->is_all()) r.stride *= 0.3;
  }
}

Refined Refiner::finish(Refinement r) {
  const State& s = *state_;
  const ElementSums sums = held_out_sums(r.best->world, s.beams, r.soft);
  s.accept("calibrate", calibrated(r.best->model, sums), r);
  elements::Model& model = r.best->model;
  return {s.options.sharpness == 1 ? std::move(model) : sharpened(model, s.options.sharpness),
          std::move(r.report)};
}

credit::BeamShare share_of_round(size_t beams, int round, const LikelihoodOptions& options) {
  const size_t shares = options.shares.size(), rounds = size_t(options.rounds);
  const size_t k = size_t(round) + (rounds < shares ? shares - rounds : 0);
  return beams < credit::kLongLog ? credit::BeamShare() : options.shares[std::min(k, shares - 1)];
}

Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const std::function<void(std::string_view, size_t, size_t)>& progress,
               RefinementLimits limits) {
  check(start, options, limits);
  const ListedBeams beams(source, options.held_out, start, kListBytes);
  Refiner refiner(start, beams, options, std::move(limits));
  Refinement r = refiner.begin();
  while (const auto share = r.wanted(options)) {
    const std::string name = r.report.steps[r.step].name;
    refiner.maximise(r,
                     expect(r.best->world, beams, *share, r.soft, [&](size_t done, size_t total) {
                       if (progress) progress(name, done, total);
                     }));
  }
  return refiner.finish(std::move(r));
}

}  // namespace underbrush::likelihood
