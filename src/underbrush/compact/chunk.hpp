/// \file
/// A chunk of a compact log: some rows of a `BeamLog`, coded without reference to other chunks. The
/// layout is described in docs/reference/compact-log.md.
#pragma once
#include <string>
#include <vector>

#include "underbrush/compact/scratch.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::compact {

/// Returns the rows [begin, begin + n) of a log as bytes. Every bit of every column comes back. The
/// better the poses of `scans` describe the motion of the sensor, the fewer bytes there are.
std::string encoded(const BeamLog& log, const std::vector<ScanInfo>& scans, size_t begin, size_t n,
                    Scratch& scratch);

/// Reads n rows into the rows [begin, begin + n) of `out`, which is as long already and has the
/// extra columns of the log that was coded. Throws `FormatError`.
void decode(Cursor& in, size_t n, Scratch& scratch, BeamLog& out, size_t begin);

}  // namespace underbrush::compact
