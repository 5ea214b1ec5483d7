/// \file
/// Temporary files and folders, which are removed even if the program is ended by a signal.
#pragma once
#include <filesystem>
#include <functional>

namespace underbrush {

/// Path of a file or folder that is removed, with its contents, when this object is destroyed or
/// when `remove_temporaries()` runs. The path need not exist.
class TemporaryPath {
 public:
  explicit TemporaryPath(std::filesystem::path path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Runs `move`, which renames the path to its final place, while `remove_temporaries()` waits.
  /// Afterwards the path is no longer removed. What `move` throws is passed on.
  void keep(const std::function<void()>& move);

 private:
  std::filesystem::path path_;
};

/// Calls `make`, which creates a file or folder at or below a `TemporaryPath`. Once
/// `remove_temporaries` has begun, `make` is not called and this function never returns.
void make_temporary(const std::function<void()>& make);
/// Calls `std::filesystem::create_directories(path)` under the rule of `make_temporary`.
void make_temporary_folders(const std::filesystem::path& path);

/// Removes the files and folders of all `TemporaryPath`s of the process; from then on none can be
/// created or destroyed. A program calls it when a signal is about to end it. The list of these
/// paths is the only global state of the library.
void remove_temporaries() noexcept;

}  // namespace underbrush
