#include "underbrush/update/fit_log_options.hpp"

#include "underbrush/core/check.hpp"

namespace underbrush::update {

std::span<const Option<FitLogOptions>> fit_log_options() {
  using O = FitLogOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"echoes", "Echoes", "",
     "first = a beam ends at its first echo; all = each echo is treated as a beam, and hit "
     "probabilities are shares of the light",
     [](O& o) -> auto& { return o.echoes; }, -kNoLimit, kNoLimit, {"first", "all"}},
    {"growth", kUpdateGroup, "",
     "Fit a tile anew when the number of its returns has grown by this share since its last fit; 0 "
     "= always, so that the elements are those of one fit of all logs",
     [](O& o) -> auto& { return o.update.growth; }, 0},
    {"logs", kUpdateGroup, "", "Folder that now holds the logs of the model",
     [](O& o) -> auto& { return o.logs; }, -kNoLimit, kNoLimit, {}, "FOLDER"},
  };
// clang-format on
return kOptions;
}

void FitLogOptions::check(bool is_update) const {
  check_options("fit", fit_log_options(), *this);
  require(is_update || (logs.empty() && update.growth == UpdateOptions().growth),
          "fit: --growth and --logs require --update");
}

}  // namespace underbrush::update
