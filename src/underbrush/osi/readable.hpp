/// \file
/// The check that the memory of a message from a caller can be read.
#pragma once
#include <string_view>

namespace underbrush::osi {

/// Whether the process may read all of these bytes. True where the system forbids the check.
bool is_readable(std::string_view bytes);

}  // namespace underbrush::osi
