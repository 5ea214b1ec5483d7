/// \file
/// Hashes of files, by which results identify their inputs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace underbrush::io {

/// Returns the hash (XXH3, 128 bits) of a file, or of all files of a folder in the order of their
/// names, as "xxh3:" and 32 hexadecimal digits.
std::string hash_of(const std::filesystem::path& path);
/// Returns the hash of several files and folders in this order, as of one folder.
std::string hash_of_all(const std::vector<std::filesystem::path>& paths);
/// Returns the number of bytes of a file, or of all files of a folder; 0 for anything else.
uint64_t size_of(const std::filesystem::path& path);

}  // namespace underbrush::io
