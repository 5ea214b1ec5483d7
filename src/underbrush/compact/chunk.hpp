/// \file
/// A chunk of a compact log: some rows of a `BeamLog`, coded without reference to other chunks. The
/// layout is described in docs/reference/compact-log.md.
#pragma once
#include <string>

#include "underbrush/compact/packed.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::compact {

/// Returns the rows [begin, begin + n) of a log as bytes. Every bit of every column comes back.
std::string encoded(const BeamLog& log, size_t begin, size_t n, Codec& codec);

/// Reads n rows into the rows [begin, begin + n) of `out`, which is as long already and has the
/// extra columns of the log that was coded. Throws `FormatError`.
void decode(Cursor& in, size_t n, Codec& codec, BeamLog& out, size_t begin);

}  // namespace underbrush::compact
