/// \file
/// Files and folders that must not outlive the work they belong to.
#pragma once
#include <filesystem>
#include <functional>

namespace underbrush {

/// A file or folder that is removed, with all in it, when this object ends, or before that by
/// `remove_temporaries()`. It need not exist.
class TemporaryPath {
 public:
  explicit TemporaryPath(std::filesystem::path path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Runs `move`, which gives the path its last place, undisturbed by `remove_temporaries()`;
  /// afterwards it is nobody's to remove. What `move` throws passes through.
  void keep(const std::function<void()>& move);

 private:
  std::filesystem::path path_;
};

/// Calls `make`, which makes a file or a folder at a `TemporaryPath` or in one; once
/// `remove_temporaries` has begun it is not called, and this does not return.
void make_temporary(const std::function<void()>& make);
/// `std::filesystem::create_directories`, likewise.
void make_temporary_folders(const std::filesystem::path& path);

/// Removes what all `TemporaryPath`s of the process hold, and lets none begin or end any more: for
/// a program that a signal is about to end. The one list of the library that is not passed down.
void remove_temporaries() noexcept;

}  // namespace underbrush
