#include "underbrush/io/atomic_file.hpp"

#include <unistd.h>

#include <atomic>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  static std::atomic<unsigned> count{0};
  fs::path target = path;
  if (target.filename().empty()) target = target.parent_path();  // "model/" names the folder
  const fs::path temporary =
      target.string() + ".part-" + std::to_string(getpid()) + "-" + std::to_string(count++);
  std::error_code ignored;
  try {
    write(temporary);
    if (fs::is_directory(temporary) && fs::exists(target)) {
      const fs::path old = temporary.string() + ".old";
      fs::rename(target, old);
      fs::rename(temporary, target);
      fs::remove_all(old, ignored);
    } else {
      fs::rename(temporary, target);
    }
  } catch (const fs::filesystem_error& e) {
    fs::remove_all(temporary, ignored);
    throw IoError(target.string() + ": cannot write: " + e.code().message());
  } catch (...) {
    fs::remove_all(temporary, ignored);
    throw;
  }
}

}  // namespace underbrush::io
