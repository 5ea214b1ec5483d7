/// \file
/// Files that gzip has packed.
#pragma once
#include <filesystem>

#include "underbrush/core/temporary.hpp"

namespace underbrush::io {

/// Whether a file's name ends with .gz.
bool is_gzip(const std::filesystem::path& path);

/// The content of a gzip file, as a file that lies in the folder for temporary files for as long as
/// this object lives. Its name is that of the packed file without .gz.
class Unpacked {
 public:
  /// Throws `FormatError` for a file that is cut off, damaged or none of gzip; `IoError` where the
  /// content cannot be written or would take more than half of the room that is free.
  explicit Unpacked(const std::filesystem::path& packed);
  const std::filesystem::path& path() const { return temporary_.path(); }

 private:
  TemporaryPath temporary_;
};

}  // namespace underbrush::io
