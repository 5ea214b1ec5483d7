/// \file
/// Temporary files and folders, which are removed even if the program is ended by a signal; the
/// remains of a killed program are removed by the next one.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

namespace underbrush {

/// A place for a file or folder that is being written: `NAME` in a private folder
/// `.underbrush-XXXXXX`, whose name cannot be guessed and which only its owner may enter. The
/// private folder and all in it is removed when this object is destroyed or when
/// `remove_temporaries()` runs.
///
/// The private folder holds a file `lock` that is locked (flock) for as long as the process lives.
/// A private folder whose lock is free was left by a process that was killed: the first
/// `TemporaryPath` that a process makes in a folder removes all of those there.
class TemporaryPath {
 public:
  /// Makes the private folder in `folder`, which must exist ("" is the working directory). Throws
  /// `std::filesystem::filesystem_error`.
  TemporaryPath(const std::filesystem::path& folder, const std::string& name);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  /// Returns the place to write to. Nothing exists there yet.
  const std::filesystem::path& path() const { return path_; }
  /// Renames the written file or folder to `NAME` in the target folder, replacing one that stands
  /// there. A reader of that name finds the old or the new one, whole. Throws
  /// `std::filesystem::filesystem_error`.
  void commit();

 private:
  std::filesystem::path private_, path_, target_;
  int lock_ = -1;
};

/// Calls `make`, which creates a file or folder in a `TemporaryPath`. Once `remove_temporaries` has
/// begun, `make` is not called and this function never returns.
void make_temporary(const std::function<void()>& make);
/// Calls `std::filesystem::create_directories(path)` under the rule of `make_temporary`.
void make_temporary_folders(const std::filesystem::path& path);

/// Removes the private folders of all `TemporaryPath`s of the process; from then on none can be
/// created or destroyed. A program calls it when a signal is about to end it. The list of these
/// folders and the listener below are the only global state of the library.
void remove_temporaries() noexcept;

/// Sets the function that is called for each folder from which the remains of `count` killed
/// processes were removed. Without one, they are removed silently.
void on_remains_removed(
    std::function<void(const std::filesystem::path& folder, size_t count)> listener);

}  // namespace underbrush
