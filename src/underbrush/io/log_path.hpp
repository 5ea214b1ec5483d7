#pragma once

#include <filesystem>

namespace underbrush::io {

/// Returns the path. Where its name or content is that of something else, throws `FormatError`,
/// which says what it is and which verb takes it.
const std::filesystem::path& checked_log_path(const std::filesystem::path& path);

}  // namespace underbrush::io
