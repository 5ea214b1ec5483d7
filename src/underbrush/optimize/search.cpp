#include "underbrush/optimize/search.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include "underbrush/core/check.hpp"

namespace underbrush::optimize {
namespace {

struct Algorithm {
  const char* name;
  nlopt_algorithm number;
  unsigned fewest;  // least number of parameters
};
constexpr Algorithm kAlgorithms[] = {
    {"cobyla", NLOPT_LN_COBYLA, 1}, {"bobyqa", NLOPT_LN_BOBYQA, 2}, {"sbplx", NLOPT_LN_SBPLX, 1}};
constexpr double kLeastStep = 0.1;    // as a share of the first step
constexpr double kConverged = 0.125;  // as a share of a run's step
// A run that only repeats known evaluations costs nothing, but it must end.
constexpr int kCallsOfRun = 1000;

using Optimizer = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;

class Searcher {
 public:
  Searcher(std::span<const Parameter> parameters, const SearchOptions& options,
           const std::function<Outcome(std::span<const double>)>& objective,
           const std::vector<Evaluation>& past,
           const std::function<void(std::span<const Evaluation>)>& after)
      : parameters_(parameters),
        options_(options),
        objective_(objective),
        past_(past),
        after_(after) {}

  /// Gives the objective at a place of the ranges: known, from the past, or newly evaluated.
  double at(const double* place) {
    std::vector<double> value(parameters_.size());
    for (size_t k = 0; k < value.size(); ++k) value[k] = value_at(parameters_[k], place[k]);
    for (const Evaluation& e : done_) {
      if (e.value == value) return e.outcome.objective;
    }
    if (done_.size() < past_.size()) {
      require_data(past_[done_.size()].value == value,
                   "optimize: the evaluations to go on from are not of this search");
      done_.push_back(past_[done_.size()]);
    } else {
      Outcome outcome = objective_(value);
      require(std::isfinite(outcome.objective), "optimize: an objective is not finite");
      done_.push_back({std::move(value), std::move(outcome)});
      if (after_) after_(done_);
    }
    return done_.back().outcome.objective;
  }

  bool spent() const { return done_.size() >= options_.budget; }
  const std::vector<Evaluation>& done() const { return done_; }

  /// Runs the algorithm once from the best evaluation so far.
  void run(const Algorithm& algorithm, double step) {
    const unsigned n = unsigned(parameters_.size());
    optimizer_ = Optimizer(nlopt_create(algorithm.number, n), nlopt_destroy);
    nlopt_opt o = optimizer_.get();
    nlopt_set_lower_bounds1(o, 0);
    nlopt_set_upper_bounds1(o, 1);
    nlopt_set_min_objective(o, call, this);
    nlopt_set_maxeval(o, kCallsOfRun);
    nlopt_set_xtol_abs1(o, kConverged * step);
    const Evaluation& best = done_[best_of(done_)];
    std::vector<double> place(n), steps(n);
    for (size_t k = 0; k < n; ++k) {
      place[k] = place_of(parameters_[k], best.value[k]);
      steps[k] = place[k] + step <= 1 ? step : -step;  // inwards
    }
    nlopt_set_initial_step(o, steps.data());
    double least = 0;
    nlopt_optimize(o, place.data(), &least);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  // NLopt is a C library, so no exception may pass through it.
  static double call(unsigned, const double* place, double*, void* self) {
    Searcher& s = *static_cast<Searcher*>(self);
    try {
      if (!s.spent()) return s.at(place);
    } catch (...) {
      s.error_ = std::current_exception();
    }
    nlopt_force_stop(s.optimizer_.get());
    return HUGE_VAL;
  }

  std::span<const Parameter> parameters_;
  const SearchOptions& options_;
  const std::function<Outcome(std::span<const double>)>& objective_;
  const std::vector<Evaluation>& past_;
  const std::function<void(std::span<const Evaluation>)>& after_;
  std::vector<Evaluation> done_;
  Optimizer optimizer_{nullptr, nlopt_destroy};
  std::exception_ptr error_;
};

const Algorithm& algorithm_named(const std::string& name, size_t parameters) {
  for (const Algorithm& a : kAlgorithms) {
    if (name != a.name) continue;
    if (parameters >= a.fewest) return a;
    throw std::invalid_argument("optimize: " + name + " needs two parameters or more");
  }
  throw std::invalid_argument("optimize: no algorithm '" + name + "'");
}

}  // namespace

std::vector<std::string> algorithms() {
  std::vector<std::string> names;
  for (const Algorithm& a : kAlgorithms) names.emplace_back(a.name);
  return names;
}

std::vector<Evaluation> search(std::span<const Parameter> parameters, std::span<const double> start,
                               const SearchOptions& options,
                               const std::function<Outcome(std::span<const double>)>& objective,
                               const std::vector<Evaluation>& past,
                               const std::function<void(std::span<const Evaluation>)>& after) {
  require(!parameters.empty(), "optimize: there is no parameter to tune");
  require(start.size() == parameters.size(), "optimize: one start a parameter is needed");
  require(options.budget > 0, "optimize: the budget must be positive");
  require(options.step > 0 && options.step <= 0.5, "optimize: the step must lie in (0, 0.5]");
  const Algorithm& algorithm = algorithm_named(options.algorithm, parameters.size());
  for (const Parameter& p : parameters) {
    require(p.low < p.high && (p.scale == Scale::kLinear || p.low > 0),
            "optimize: a parameter's range is empty");
  }
  Searcher searcher(parameters, options, objective, past, after);
  std::vector<double> place(start.size());
  for (size_t k = 0; k < place.size(); ++k) place[k] = place_of(parameters[k], start[k]);
  searcher.at(place.data());
  for (double step = options.step; step >= kLeastStep * options.step; step /= 2) {
    if (searcher.spent()) break;
    searcher.run(algorithm, step);
  }
  return searcher.done();
}

size_t best_of(std::span<const Evaluation> evaluations) {
  const auto least = std::min_element(evaluations.begin(), evaluations.end(),
                                      [](const Evaluation& a, const Evaluation& b) {
                                        return a.outcome.objective < b.outcome.objective;
                                      });
  return size_t(least - evaluations.begin());
}

}  // namespace underbrush::optimize
