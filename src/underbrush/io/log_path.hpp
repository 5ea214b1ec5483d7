#pragma once

#include <filesystem>

namespace underbrush::io {

/// Returns the path. Where its name or content is that of another kind of file, throws
/// `FormatError`, which names the kind and the verb that takes it.
const std::filesystem::path& checked_log_path(const std::filesystem::path& path);

/// Throws `FormatError` where a folder is a model or a scene.
void refuse_world(const std::filesystem::path& folder);

}  // namespace underbrush::io
