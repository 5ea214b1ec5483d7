/// \file
/// The verb `movers`: a log in, the same log with marks at the returns of moving things out.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "underbrush/movers/find_movers.hpp"

namespace underbrush::pipeline {

/// The marks of a log's rows (1 = a return of something that moved), and their number.
struct MoverMarks {
  std::vector<uint8_t> mark;
  size_t returns = 0, marked = 0;
};

/// Marks the returns of things that moved during a log, which messages call `file`. `write`
/// receives the marked log chunk by chunk, each with the marks of its rows. `progress(done, total)`
/// may be empty. Throws `FormatError` for a log of one scan and `std::invalid_argument` for options
/// out of range.
MoverMarks mark_movers(BeamSource& log, const std::string& file,
                       const movers::MoverOptions& options,
                       const std::function<void(const BeamLog&, std::span<const uint8_t>)>& write,
                       const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::pipeline
