/// \file
/// Writes that appear whole or not at all.
#pragma once
#include <filesystem>
#include <functional>
#include <string_view>

#include "underbrush/core/temporary.hpp"

namespace underbrush {
/// Others' file formats, and our own log files.
namespace io {

/// What an output is to be.
enum class OutputKind { kFile, kFolder };

/// A file or folder under way: made under the name `temporary()`, which lies beside `path`.
class AtomicFile {
 public:
  /// Throws `IoError` where something of the other kind, a device or a pipe stands at `path`.
  explicit AtomicFile(const std::filesystem::path& path, OutputKind kind = OutputKind::kFile);

  /// Without `commit()`, what was made is removed, also by `remove_temporaries()`.
  const std::filesystem::path& temporary() const { return temporary_.path(); }
  /// Renames the result to `path`; an existing folder there is replaced. Throws `IoError`.
  void commit();

 private:
  std::filesystem::path target_;
  OutputKind kind_;
  TemporaryPath temporary_;
};

/// Calls `write(temporary)` with a name beside `path`, then renames the result to `path`; removes
/// it if `write` throws. `write` makes a file or a folder; an existing folder at `path` is
/// replaced. Throws `IoError` (one line, names the file) where the file system refuses.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write,
                      OutputKind kind = OutputKind::kFile);

/// Likewise a file of these bytes.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws the `IoError` that writing to `path` would end with now (no such folder, no permission,
/// something else stands there): to be asked before long work.
void check_output(const std::filesystem::path& path, OutputKind kind = OutputKind::kFile);

}  // namespace io
}  // namespace underbrush
