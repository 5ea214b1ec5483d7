/// \file
/// Hashes of files, for the provenance of results.
#pragma once
#include <filesystem>
#include <string>

namespace underbrush::app {

/// Returns the hash (XXH3, 128 bits) of a file, or of all files of a folder in the order of their
/// names, as "xxh3:" and 32 hexadecimal digits.
std::string hash_of(const std::filesystem::path& path);

}  // namespace underbrush::app
