#include "underbrush/pipeline/mark_movers.hpp"

#include <algorithm>

#include "underbrush/core/range_unit.hpp"

namespace underbrush::pipeline {

MoverMarks mark_movers(BeamSource& log, const std::string& file,
                       const movers::MoverOptions& options,
                       const std::function<void(const BeamLog&, std::span<const uint8_t>)>& write,
                       const std::function<void(size_t, size_t)>& progress) {
  options.check();
  require_metres(log, "movers");
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
