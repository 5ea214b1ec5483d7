#include "underbrush/likelihood/likelihood.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "underbrush/core/check.hpp"

namespace underbrush::likelihood {
namespace {

using Progress = std::function<void(std::string_view, size_t, size_t)>;

/// The memory for training beams, bytes.
constexpr size_t kListBytes = size_t(1) << 29;
/// The length of M-steps, shorter than 1 because neighbours move at once.
constexpr double kStride = 0.8;
/// The best model so far, and trials of other models against it.
class ModelSearch {
 public:
  ModelSearch(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
              const Progress& progress, const std::vector<bool>& moving)
      : options_(options),
        progress_(progress),
        moving_(moving),
        beams_(source, options.held_out, start, kListBytes),
        neighbours_(start.ellipsoids) {
    soft_.miss = options.dropout;
    best_ = state_of(with_densities(start, options.range_noise_m, options.maximisation));
    note("start", *best_, true);
  }

  Refined result() {
    report_.training_beams = beams_.training_beams();
    report_.held_out_beams = beams_.held_out().size();
    report_.held_out_hits = beams_.held_out_hits();
    elements::Model& model = best_->model;
    return {options_.sharpness == 1 ? std::move(model) : sharpened(model, options_.sharpness),
            std::move(report_)};
  }

  /// Keeps the model after an M-step from a share of the training beams if it explains the
  /// held-out beams better.
  bool maximise(double stride, credit::BeamShare share) {
    auto trial = state_of(step_of(*best_, stride, share));
    return accept("maximise", trial);
  }
  /// Corrects the densities by the held-out beams.
  void calibrate() {
    const ElementSums sums = held_out_sums(best_->world, beams_, soft_);
    auto trial = state_of(calibrated(best_->model, sums));
    accept("calibrate", trial);
  }
  size_t training_beams() const { return beams_.training_beams(); }

 private:
  /// A model with its likelihood for the held-out beams and, if an M-step started from it, the sums
  /// over the training beams.
  struct State {
    explicit State(elements::Model m) : model(std::move(m)), world(model) {}

    elements::Model model;
    trace::World world;
    double held_out_nll = 0;
    std::optional<ElementSums> sums;
    credit::BeamShare share;  ///< The training beams that `sums` are of.
    size_t step = 0;          ///< Its place in the report.
  };

  std::unique_ptr<State> state_of(elements::Model model) const {
    auto s = std::make_unique<State>(std::move(model));
    s->held_out_nll = judge(s->world, beams_);
    return s;
  }

  /// Returns the sums of the elements over a share of the training beams, with a pass over these
  /// beams if none was made yet.
  const ElementSums& sums_of(State& s, credit::BeamShare share = {}) {
    if (s.sums && s.share == share) return *s.sums;
    LikelihoodStep& step = report_.steps[s.step];
    Expectation seen = expect(s.world, beams_, share, soft_, [&](size_t done, size_t total) {
      if (progress_) progress_(step.name, done, total);
    });
    step.training_nll = seen.nll;
    report_.stray_hits = seen.stray_hits;
    // The start leaves more unexplained than any model after it.
    if (step.accepted && s.step > 0) soft_.hit = std::clamp(seen.stray_hits, 1e-4, 0.2);
    s.share = share;
    return s.sums.emplace(std::move(seen.sums));
  }

  elements::Model step_of(State& s, double stride, credit::BeamShare share = {}) {
    elements::Model next =
        maximised(s.model, sums_of(s, share), neighbours_, options_.maximisation, stride);
    if (!moving_.empty()) keep_others(s.model, next);
    return next;
  }

  /// Puts all elements back that may not move, and what the triangles of a mesh share.
  void keep_others(const elements::Model& now, elements::Model& next) const {
    size_t element = 0;
    for (auto mesh : {&elements::Model::ground, &elements::Model::surface}) {
      const elements::TriangleMesh& before = now.*mesh;
      elements::TriangleMesh& after = next.*mesh;
      after.range_sigma_m = before.range_sigma_m;
      after.roughness_m = before.roughness_m;
      for (uint32_t t = 0; t < before.size(); ++t, ++element) {
        if (moving_[element]) continue;
        after.hit[t] = before.hit[t];
        if (!after.roughness.empty()) after.roughness[t] = float(before.roughness_at(t));
      }
    }
    for (size_t k = 0; k < now.ellipsoids.size(); ++k, ++element) {
      if (!moving_[element]) next.ellipsoids[k] = now.ellipsoids[k];
    }
  }

  bool accept(const char* name, std::unique_ptr<State>& trial) {
    const bool better = trial->held_out_nll < best_->held_out_nll - options_.least_gain;
    note(name, *trial, better);
    if (better) best_ = std::move(trial);
    return better;
  }

  void note(const char* name, State& s, bool accepted) {
    s.step = report_.steps.size();
    report_.steps.push_back({name, s.model.size(), {}, s.held_out_nll, accepted});
  }

  const LikelihoodOptions& options_;
  const Progress& progress_;
  trace::OutlierShares soft_;
  const std::vector<bool>& moving_;
  ListedBeams beams_;
  Neighbours neighbours_;
  std::unique_ptr<State> best_;
  LikelihoodReport report_;
};

}  // namespace

credit::BeamShare share_of_round(size_t beams, int round, int rounds) {
  constexpr std::array<credit::BeamShare, 4> kFirst{{{0, 2}, {2, 4}, {4, 6}, {6, 8}}};
  const size_t last = kFirst.size();
  const size_t k = size_t(round) + (size_t(rounds) < last + 1 ? last + 1 - size_t(rounds) : 0);
  return beams < credit::kLongLog || k >= last ? credit::BeamShare() : kFirst[k];
}

Refined refine(const elements::Model& start, BeamSource& source, const LikelihoodOptions& options,
               const Progress& progress, const std::vector<bool>& moving) {
  require(start.voxel_m == 0, "likelihood: ellipsoids bounded by voxels cannot be refined");
  require(options.held_out.one_in > 1, "likelihood: some of the beams must be held out");
  require(options.dropout > 0 && options.dropout <= 0.9, "likelihood: dropout must be in (0, 0.9]");
  require(options.maximisation.spent_at_start >= 0,
          "likelihood: the start's parameters must not be negative");
  require(options.sharpness >= 0.1 && options.sharpness <= 10,
          "likelihood: sharpness must be in [0.1, 10]");
  require(moving.empty() || moving.size() == start.size(),
          "likelihood: `moving` must have an entry for each element");
  ModelSearch search(start, source, options, progress, moving);
  double stride = kStride;
  for (int round = 0; round < options.rounds; ++round) {
    const credit::BeamShare share = share_of_round(search.training_beams(), round, options.rounds);
    if (search.maximise(stride, share) || !share.is_all()) continue;
    if ((stride *= 0.3) < 0.05) break;
  }
  search.calibrate();
  return search.result();
}

}  // namespace underbrush::likelihood
