/// \file
/// The primitives of a set, and edits of them: docs/reference/serve-api.md.
#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "underbrush/serve/opened_files.hpp"
#include "underbrush/serve/query.hpp"

namespace underbrush::serve {

/// Describes the primitives of a set as JSON: facts, given names and origins, the hash of the set
/// by which edits name it, and the classes of primitives. Throws `FormatError`, and
/// `std::invalid_argument` for a file of another kind.
std::string primitives_json(const OpenedFile& file);

/// Writes lists of edits of primitives. A list that one request has no room for comes in parts.
class PrimitiveEdits {
 public:
  /// Takes edits of the set `file`, a JSON list in the parameter `edits`, for the file `path`, on
  /// any number of threads. With the parameter `more`, further edits for the file will follow, and
  /// nothing is written yet; else all are written. Returns the number of edits that it has of the
  /// file. Throws `FormatError` for edits that cannot be applied, which begins the list anew, and
  /// `IoError`.
  size_t add(const std::filesystem::path& path, const OpenedFile& file, const Query& query);

 private:
  std::mutex mutex_;
  std::map<std::filesystem::path, std::string> begun_;  ///< JSON lists that are not written yet.
};

}  // namespace underbrush::serve
