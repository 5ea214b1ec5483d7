/// \file
/// This file reads and writes lists of objects, as CSV or JSON (docs/reference/object-lists.md).
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// Writes lists as CSV (a row for each object) or as JSON, by the extension; atomically. A list
/// without objects is a row whose id is 0. `provenance` is JSON, which only JSON files hold. Throws
/// `std::invalid_argument` for another extension and `IoError`.
void write_object_lists(const std::filesystem::path& path, std::span<const ObjectList> lists,
                        const std::string& provenance);

/// Reads lists that `write_object_lists` wrote. A value that a file lacks stays at its default,
/// except for the time, the id and the box. Throws `FormatError` for a malformed file, for numbers
/// that are not finite, and for times that do not ascend.
std::vector<ObjectList> read_object_lists(const std::filesystem::path& path);

/// Whether a file is a list of objects by its extension and its beginning.
bool is_object_list_file(const std::filesystem::path& path);

}  // namespace underbrush::perception
