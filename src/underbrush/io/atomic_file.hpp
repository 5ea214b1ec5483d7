/// \file
/// Writes that appear whole or not at all.
#pragma once
#include <filesystem>
#include <functional>

namespace underbrush {
/// Others' file formats, and our own log files.
namespace io {

/// A file or folder under way: made under the name `temporary()`, which lies beside `path`.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  /// Without `commit()`, removes what was made.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }
  /// Renames the result to `path`; an existing folder there is replaced. Throws `IoError`.
  void commit();

 private:
  std::filesystem::path target_, temporary_;
};

/// Calls `write(temporary)` with a name beside `path`, then renames the result to `path`; removes
/// it if `write` throws. `write` makes a file or a folder; an existing folder at `path` is
/// replaced. Throws `IoError` (one line, names the file) where the file system refuses.
void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write);

}  // namespace io
}  // namespace underbrush
