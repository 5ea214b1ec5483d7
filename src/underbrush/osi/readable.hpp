/// \file
/// Whether a message that somebody else points to is there.
#pragma once
#include <string_view>

namespace underbrush::osi {

/// Whether the process may read all of these bytes. True where the system does not tell.
bool is_readable(std::string_view bytes);

}  // namespace underbrush::osi
