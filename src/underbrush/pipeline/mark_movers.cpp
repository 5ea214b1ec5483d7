#include "underbrush/pipeline/mark_movers.hpp"

#include <algorithm>

namespace underbrush::pipeline {
std::span<const Option<movers::MoverOptions>> mover_options() {
  using O = movers::MoverOptions;
  // clang-format off
  static const Option<O> kOptions[] = {
    {"look-s", "Search", "s", "Times before and after a scan at which other scans are compared with it",
     [](O& o) -> auto& { return o.look_s; }, 0.01, 1e4},
    {"least-empty", "Search", "", "Number of the outermost scans in which the place of a mover must be empty",
     [](O& o) -> auto& { return o.least_empty; }},
    {"cell-deg", "Search", "degrees", "Width of the cells in which scans are compared",
     [](O& o) -> auto& { return o.cell_deg; }, 0.05, 30},
    {"max-range", "Search", "m", "Largest range of the returns that may be marked",
     [](O& o) -> auto& { return o.max_range_m; }, 0.1, 1e6},
    {"same-m", "Search", "m", "Largest difference of two ranges of one surface, to which 1 % of the range is added",
     [](O& o) -> auto& { return o.same_m; }, 0, 100},
    {"least-points", "Search", "", "Returns of the smallest mover in a scan",
     [](O& o) -> auto& { return o.least_points; }},
  };
// clang-format on
return kOptions;
}

MoverMarks mark_movers(BeamSource& log, const std::string& file,
                       const movers::MoverOptions& options,
                       const std::function<void(const BeamLog&, std::span<const uint8_t>)>& write,
                       const std::function<void(size_t, size_t)>& progress) {
  options.check();
  movers::require_two_scans(log, file);
  MoverMarks out;
  out.mark = movers::find_movers(log, options, progress);
  out.marked = size_t(std::count(out.mark.begin(), out.mark.end(), 1));
  log.rewind();
  size_t row = 0;
  for (BeamLog chunk; log.next(chunk); row += chunk.size()) {
    movers::mark_movers(out.mark, row, chunk);
    for (size_t i = 0; i < chunk.size(); ++i) out.returns += chunk.is_hit(i);
    write(chunk, std::span(out.mark).subspan(row, chunk.size()));
  }
  return out;
}

}  // namespace underbrush::pipeline
