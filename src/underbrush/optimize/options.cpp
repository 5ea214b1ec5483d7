#include "underbrush/optimize/options.hpp"

#include "underbrush/core/check.hpp"
#include "underbrush/optimize/objective.hpp"

namespace underbrush::optimize {
namespace {

std::vector<std::string_view> views(const std::vector<std::string>& words) {
  return {words.begin(), words.end()};
}

}  // namespace

std::span<const Option<TuneOptions>> tune_options() {
  using O = TuneOptions;
  static const std::vector<std::string> kObjectives = objectives(), kAlgorithms = algorithms();
  // clang-format off
  static const Option<O> kOptions[] = {
    {"objective", "", "",
     "What is minimised: packet_f1 = mean packet error + 2 (1 - F1); nll = the mean negative "
     "log-likelihood of a beam",
     [](O& o) -> auto& { return o.objective; }, -kNoLimit, kNoLimit, views(kObjectives)},
    {"tune", "", "", "Options of fit to tune instead of the usual ones",
     [](O& o) -> auto& { return o.tune; }, -kNoLimit, kNoLimit, {}, "NAME ..."},
    {"budget", "", "", "Largest number of evaluations",
     [](O& o) -> auto& { return o.search.budget; }, 1, kNoLimit},
    {"slice", "", "", "Use the scans that begin in [FROM, TO), s after the log's start",
     [](O& o) -> auto& { return o.slice; }, -kNoLimit, kNoLimit, {}, "FROM TO", 2},
    {"validate", "", "",
     "Score every N-th scan and fit the others; where there are fewer than N scans, groups of beams "
     "take the place of scans",
     [](O& o) -> auto& { return o.validate; }, 2, 1 << 30},

    {"algorithm", "Search", "", "Search algorithm of NLopt",
     [](O& o) -> auto& { return o.search.algorithm; }, -kNoLimit, kNoLimit, views(kAlgorithms)},
    {"step", "Search", "", "First step, as a share of each parameter's range",
     [](O& o) -> auto& { return o.search.step; }, 0.001, 0.5},
  };
// clang-format on
return kOptions;
}

SliceOptions TuneOptions::cut() const {
  check_options("optimize", tune_options(), *this);
  require(slice.size() == 2, "optimize: slice has two numbers");
  return {slice[0], slice[1], validate, seed};
}

}  // namespace underbrush::optimize
