#include "underbrush/io/atomic_file.hpp"

#include <unistd.h>

#include <atomic>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;

AtomicFile::AtomicFile(const fs::path& path) : target_(path) {
  static std::atomic<unsigned> count{0};
  if (target_.filename().empty()) target_ = target_.parent_path();  // "model/" names the folder
  temporary_ =
      target_.string() + ".part-" + std::to_string(getpid()) + "-" + std::to_string(count++);
}

AtomicFile::~AtomicFile() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void AtomicFile::commit() {
  try {
    if (fs::is_directory(temporary_) && fs::exists(target_)) {
      const fs::path old = temporary_.string() + ".old";
      fs::rename(target_, old);
      fs::rename(temporary_, target_);
      std::error_code ignored;
      fs::remove_all(old, ignored);
    } else {
      fs::rename(temporary_, target_);
    }
    temporary_.clear();
  } catch (const fs::filesystem_error& e) {
    throw IoError(target_.string() + ": cannot write: " + e.code().message());
  }
}

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  AtomicFile file(path);
  try {
    write(file.temporary());
  } catch (const fs::filesystem_error& e) {
    throw IoError(path.string() + ": cannot write: " + e.code().message());
  }
  file.commit();
}

}  // namespace underbrush::io
