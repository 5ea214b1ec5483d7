/// \file
/// Output files and folders that appear whole or not at all.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "underbrush/core/temporary.hpp"

namespace underbrush {
/// Readers and writers of third-party file formats and of Underbrush's own log files.
namespace io {

/// Whether an output is a file or a folder.
enum class OutputKind { kFile, kFolder };

/// A file or folder that is being written. It is created as `temporary()`, in a private folder
/// beside `path`, and renamed by `commit()`.
class AtomicFile {
 public:
  /// Throws `IoError` where nothing can be written beside `path`, and where `path` exists as the
  /// other kind, or as a device or pipe.
  explicit AtomicFile(const std::filesystem::path& path, OutputKind kind = OutputKind::kFile);

  /// Returns the path to write to. Without `commit()` the file or folder there is removed when this
  /// object is destroyed, or by `remove_temporaries()`.
  const std::filesystem::path& temporary() const { return temporary_->path(); }
  /// Renames the result to `path`, replacing a file or folder there. Throws `IoError`.
  void commit();

 private:
  std::string name_;
  std::unique_ptr<TemporaryPath> temporary_;
};

/// Calls `write(temporary)` with a place beside `path`, then renames the file or folder that
/// `write` made to `path`, replacing a file or folder there. If `write` throws, its output is
/// removed. Throws `IoError` (one line that names the file) where the file system refuses.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write,
                      OutputKind kind = OutputKind::kFile);

/// Writes a file that consists of `bytes`, atomically. Throws `IoError`.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws the `IoError` that writing to `path` would end with (no such folder, no permission, path
/// exists as another kind). Callers use it before a long computation.
void check_output(const std::filesystem::path& path, OutputKind kind = OutputKind::kFile);
/// The check for a folder, which may replace one that stands there only if that is empty or
/// `is_ours`. `what` describes any other folder, such as "not a model".
void check_output_folder(const std::filesystem::path& path, bool is_ours, const std::string& what);

}  // namespace io
}  // namespace underbrush
