#include "underbrush/io/atomic_file.hpp"

#include <string>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

// Strips a trailing slash: "model/" names the folder "model".
fs::path without_slash(const fs::path& path) {
  return path.filename().empty() ? path.parent_path() : path;
}

// Returns the path to rename to. Throws `IoError` where an output of this kind cannot stand.
fs::path checked_target(const fs::path& path, OutputKind kind) {
  const auto refuse = [&](const std::string& reason) {
    throw IoError(path.string() + ": cannot write: " + reason);
  };
  const fs::path target = without_slash(path);
  const fs::path name = target.filename();
  if (name.empty() || name == "." || name == "..") refuse("an output needs a name of its own");
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!fs::exists(status)) {
    if (kind == OutputKind::kFile && path.filename().empty()) refuse("names a folder");
    return target;
  }
  if (kind == OutputKind::kFile && fs::is_directory(status)) refuse("is a folder");
  if (kind == OutputKind::kFolder && !fs::is_directory(status)) refuse("is not a folder");
  // A rename would replace a device by a file.
  if (kind == OutputKind::kFile && !fs::is_regular_file(status)) refuse("is not a regular file");
  return target;
}

std::unique_ptr<TemporaryPath> temporary_beside(const fs::path& path, const fs::path& target) {
  try {
    return std::make_unique<TemporaryPath>(target.parent_path(), target.filename().string());
  } catch (const fs::filesystem_error& e) {
    throw IoError(path.string() + ": cannot write: " + e.code().message());
  }
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path, OutputKind kind)
    : name_(path.string()), temporary_(temporary_beside(path, checked_target(path, kind))) {}

void AtomicFile::commit() {
  try {
    temporary_->commit();
  } catch (const fs::filesystem_error& e) {
    throw IoError(name_ + ": cannot write: " + e.code().message());
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

void check_output(const fs::path& path, OutputKind kind) { const AtomicFile file(path, kind); }

void check_output_folder(const fs::path& path, bool is_ours, const std::string& what) {
  check_output(path, OutputKind::kFolder);
  if (!fs::exists(path) || is_ours || fs::is_empty(path)) return;
  throw IoError(path.string() + ": cannot write: exists and is " + what +
                "; remove it or name another");
}

}  // namespace underbrush::io
