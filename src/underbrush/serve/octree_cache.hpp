/// \file
/// Octrees of log files, built once and kept in a cache.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "underbrush/serve/octree.hpp"

namespace underbrush::serve {

/// Returns the user's cache: `underbrush` in $XDG_CACHE_HOME, or in ~/.cache. Throws `IoError`
/// where neither that variable nor HOME is set to an absolute path.
std::filesystem::path user_cache();

/// Returns the file in `cache` that holds the octree of the log file `log`:
/// NAME-HASH.octree, with a hash of the log's full path.
std::filesystem::path octree_place(const std::filesystem::path& log,
                                   const std::filesystem::path& cache);

/// Returns the octree of a log that the cache holds, or null where it holds none, or one of a file
/// of another size or time of change, or where there is no such log.
std::shared_ptr<const OctreeFile> kept_octree(const std::filesystem::path& log,
                                              const std::filesystem::path& cache);

/// Opens the octree of a log. Unless the cache holds one of a file of the same path, size and time
/// of change, it is built and put there, whole or not at all. Throws `FormatError` where the log
/// cannot be read, `DataError` where it has scans without beams, and what `build_octree` throws.
std::shared_ptr<const OctreeFile> cached_octree(
    const std::filesystem::path& log, const std::filesystem::path& cache,
    const std::function<void(size_t done, size_t total)>& progress = {});

}  // namespace underbrush::serve
