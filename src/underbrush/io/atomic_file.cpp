#include "underbrush/io/atomic_file.hpp"

#include <unistd.h>

#include <atomic>
#include <string>

#include "underbrush/core/check.hpp"
#include "underbrush/io/file.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

// Strips a trailing slash: "model/" names the folder "model".
fs::path without_slash(const fs::path& path) {
  return path.filename().empty() ? path.parent_path() : path;
}

fs::path temporary_beside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  return path.string() + ".part-" + std::to_string(getpid()) + "-" + std::to_string(count++);
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path, OutputKind kind)
    : target_(without_slash(path)), kind_(kind), temporary_(temporary_beside(target_)) {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  const auto refuse = [&](const char* reason) {
    throw IoError(path.string() + ": cannot write: " + reason);
  };
  if (!fs::exists(status)) {
    if (kind == OutputKind::kFile && path.filename().empty()) refuse("names a folder");
    return;
  }
  if (kind == OutputKind::kFile && fs::is_directory(status)) refuse("is a folder");
  if (kind == OutputKind::kFolder && !fs::is_directory(status)) refuse("is not a folder");
  // A rename would replace a device by a file.
  if (kind == OutputKind::kFile && !fs::is_regular_file(status)) refuse("is not a regular file");
}

void AtomicFile::commit() {
  try {
    temporary_.keep([&] {
      if (kind_ == OutputKind::kFolder && fs::exists(target_)) {
        const fs::path old = temporary().string() + ".old";
        fs::rename(target_, old);
        fs::rename(temporary(), target_);
        std::error_code ignored;
        fs::remove_all(old, ignored);
      } else {
        fs::rename(temporary(), target_);
      }
    });
  } catch (const fs::filesystem_error& e) {
    throw IoError(target_.string() + ": cannot write: " + e.code().message());
  }
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write,
                      OutputKind kind) {
  AtomicFile file(path, kind);
  try {
    write(file.temporary());
  } catch (const fs::filesystem_error& e) {
    throw IoError(path.string() + ": cannot write: " + e.code().message());
  }
  file.commit();
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  write_atomically(path, [&](const fs::path& temporary) {
    OutputFile file(temporary, path.string());
    file.append(bytes.data(), bytes.size());
    file.close();
  });
}

void check_output(const fs::path& path, OutputKind kind) {
  const AtomicFile file(path, kind);
  OutputFile(file.temporary(), path.string()).close();
}

}  // namespace underbrush::io
