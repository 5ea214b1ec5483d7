#include "underbrush/movers/mover_options.hpp"

namespace underbrush::movers {

std::span<const Option<MoverOptions>> mover_options() {
  using O = MoverOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"look-s", "Search", "s", "Times before and after a scan at which other scans are compared with it",
     [](O& o) -> auto& { return o.look_s; }, 0.01, 1e4},
    {"least-empty", "Search", "",
     "A return counts as moving if its place is empty in the N first or the N last of the compared "
     "scans that measured the place",
     [](O& o) -> auto& { return o.least_empty; }},
    {"cell-deg", "Search", "degrees", "Width of the cells in which scans are compared",
     [](O& o) -> auto& { return o.cell_deg; }, 0.05, 30},
    {"max-range", "Search", "m", "Largest range of the returns that may be marked",
     [](O& o) -> auto& { return o.max_range_m; }, 0.1, 1e6},
    {"same-m", "Search", "m",
     "Largest difference of two ranges of one surface; 1 % of the range is added",
     [](O& o) -> auto& { return o.same_m; }, 0, 100},
    {"least-points", "Search", "", "Least number of returns of a moving object in a scan",
     [](O& o) -> auto& { return o.least_points; }},
  };
// clang-format on
return kOptions;
}

}  // namespace underbrush::movers
