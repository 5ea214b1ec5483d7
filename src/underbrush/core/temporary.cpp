#include "underbrush/core/temporary.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string_view>
#include <tuple>
#include <vector>

namespace underbrush {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPrefix = ".underbrush-", kUnique = "XXXXXX";
constexpr const char* kLock = "lock";
constexpr const char* kReplaced = "replaced";  // folder of what a commit is about to replace

struct Registry {
  std::mutex mutex;
  std::set<fs::path> paths;    // the private folders of this process
  std::set<fs::path> cleaned;  // folders in which no remains are looked for any more
  std::function<void(const fs::path&, size_t)> listener;
};

// The registry is never destroyed, because threads may outlive `main`.
Registry& registry() {
  static Registry& all = *new Registry;
  return all;
}

[[noreturn]] void fail(const fs::path& path) {
  throw fs::filesystem_error("cannot write", path, std::error_code(errno, std::generic_category()));
}

// Opens and locks the lock file of a private folder; -1 if a process holds it, it does not exist or
// was removed meanwhile.
int take_lock(const fs::path& folder) {
  const int fd = ::open((folder / kLock).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) return -1;
  struct stat status {};
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0 && ::fstat(fd, &status) == 0 && status.st_nlink > 0) {
    return fd;
  }
  ::close(fd);
  return -1;
}

bool is_private_folder(const fs::path& path) {
  const std::string name = path.filename().string();
  struct stat status {};
  return name.size() == kPrefix.size() + kUnique.size() && name.starts_with(kPrefix) &&
         ::lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
         status.st_uid == ::geteuid() && (status.st_mode & 0777) == 0700;
}

// Removes a private folder, its lock last: as long as anything is left in it, the lock tells whose
// it is.
void remove_private(const fs::path& folder, std::error_code& error) {
  std::error_code ignored;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() != kLock) fs::remove_all(it->path(), ignored);
  }
  if (!error) fs::remove_all(folder, error);
}

// A process may have been killed after it moved the old output away and before it put the new one
// in its place: the old one goes back.
void put_back(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& old : fs::directory_iterator(folder / kReplaced, error)) {
    const fs::path place = folder.parent_path() / old.path().filename();
    if (!fs::exists(fs::symlink_status(place, error))) fs::rename(old.path(), place, error);
  }
}

// Removes the private folder of a process that is no more; false if the process lives.
bool remove_remains(const fs::path& folder) {
  std::error_code error;
  const int lock = take_lock(folder);
  if (lock < 0) return ::rmdir(folder.c_str()) == 0;  // killed before it had a lock
  put_back(folder);
  remove_private(folder, error);
  ::close(lock);
  return !error;
}

// Removes what killed processes left in `folder`, once.
void clean(Registry& all, const fs::path& folder) {
  if (!all.cleaned.insert(folder).second) return;
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_private_folder(it->path()) && !all.paths.contains(it->path())) {
      found.push_back(it->path());
    }
  }
  size_t removed = 0;
  for (const fs::path& path : found) removed += remove_remains(path);
  if (removed && all.listener) all.listener(folder, removed);
}

// Another process that cleans may remove the folder before it is locked: then try again.
std::pair<fs::path, int> make_private_folder(const fs::path& folder) {
  for (int tries = 0; tries < 100; ++tries) {
    std::string name = (folder / (std::string(kPrefix) + std::string(kUnique))).string();
    if (!::mkdtemp(name.data())) fail(folder);
    const fs::path file = fs::path(name) / kLock;
    const int lock = ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_CREAT | O_EXCL, 0600);
    if (lock < 0) {
      if (errno == ENOENT) continue;
      const int reason = errno;
      std::error_code ignored;
      fs::remove_all(name, ignored);
      errno = reason;
      fail(folder);
    }
    // A file system without locks is written to without one; nobody then takes the folder for
    // remains, because nobody can lock it.
    const bool taken = ::flock(lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    struct stat status {};
    if (!taken && ::fstat(lock, &status) == 0 && status.st_nlink > 0) return {name, lock};
    ::close(lock);
  }
  errno = EBUSY;
  fail(folder);
}

}  // namespace

TemporaryPath::TemporaryPath(const fs::path& folder, const std::string& name) {
  const fs::path place = folder.empty() ? fs::path(".") : folder;
  Registry& all = registry();
  const std::lock_guard guard(all.mutex);
  clean(all, place);
  std::tie(private_, lock_) = make_private_folder(place);
  all.paths.insert(private_);
  path_ = private_ / name;
  target_ = place / name;
}

TemporaryPath::~TemporaryPath() {
  const std::lock_guard guard(registry().mutex);
  registry().paths.erase(private_);
  std::error_code ignored;
  remove_private(private_, ignored);
  ::close(lock_);
}

void TemporaryPath::commit() {
  const std::lock_guard guard(registry().mutex);
  if (!fs::is_directory(fs::symlink_status(path_)) || !fs::exists(fs::symlink_status(target_))) {
    fs::rename(path_, target_);
  } else if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE)) {
    // The file system cannot exchange two folders: the old one waits in the private folder.
    const fs::path old = private_ / kReplaced / target_.filename();
    fs::create_directory(old.parent_path());
    fs::rename(target_, old);
    std::error_code error;
    fs::rename(path_, target_, error);
    if (!error) return;
    fs::rename(old, target_);
    throw fs::filesystem_error("cannot write", target_, error);
  }
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
      remove_private(path, error);
      if (!error) break;
    }
  }
}

void on_remains_removed(std::function<void(const fs::path& folder, size_t count)> listener) {
  const std::lock_guard lock(registry().mutex);
  registry().listener = std::move(listener);
}

}  // namespace underbrush
