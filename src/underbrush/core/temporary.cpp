#include "underbrush/core/temporary.hpp"

#include <mutex>
#include <set>

namespace underbrush {
namespace fs = std::filesystem;
namespace {

struct Registry {
  std::mutex mutex;
  std::set<fs::path> paths;
};

// The registry is never destroyed, because threads may outlive `main`.
Registry& registry() {
  static Registry& all = *new Registry;
  return all;
}

}  // namespace

TemporaryPath::TemporaryPath(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(registry().mutex);
  registry().paths.insert(path_);
}

TemporaryPath::~TemporaryPath() {
  const std::lock_guard lock(registry().mutex);
  if (registry().paths.erase(path_) == 0) return;  // The path was kept, or removed already.
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void TemporaryPath::keep(const std::function<void()>& move) {
  const std::lock_guard lock(registry().mutex);
  move();
  registry().paths.erase(path_);
}

void make_temporary(const std::function<void()>& make) {
  const std::lock_guard lock(registry().mutex);
  make();
}

void make_temporary_folders(const fs::path& path) {
  make_temporary([&] { fs::create_directories(path); });
}

void remove_temporaries() noexcept {
  registry().mutex.lock();  // The lock is never released, so that no path can be added any more.
  for (const fs::path& path : registry().paths) {
    std::error_code error;
    // Other threads may still be adding files to a folder.
    for (int tries = 0; tries < 100; ++tries) {
      fs::remove_all(path, error);
      if (!error) break;
    }
  }
}

}  // namespace underbrush
