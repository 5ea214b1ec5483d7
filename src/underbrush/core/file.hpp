/// \file
/// Files as bytes, with a clear one-line error for whatever goes wrong.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace underbrush {

/// A regular file, open for reading at any offset; several threads may share it.
class InputFile {
 public:
  /// Throws `FormatError` if the file does not exist, is a folder, or may not be read.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }
  /// Fills `to` with the bytes [offset, offset + n). Throws `FormatError` where the file ends
  /// before.
  void read(uint64_t offset, void* to, size_t n) const;

 private:
  int fd_ = -1;
  uint64_t size_ = 0;
  std::string name_;
};

/// Reads a whole file. Throws `FormatError` as `InputFile` does, and where the file is larger than
/// `limit` bytes.
std::string read_file(const std::filesystem::path& path, uint64_t limit = uint64_t(1) << 36);

/// Whether a regular file is there; false, too, for a name that no file can have, such as one that
/// is too long.
bool is_file(const std::filesystem::path& path);

/// Whether `name`, relative to `folder`, leads out of that folder: it is absolute, or goes up by
/// "..", or a symbolic link leads out.
bool leads_out(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Writes a new file that consists of `bytes`. Throws `IoError`; also if the file exists.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// A new file, written from its beginning; bytes written before can be overwritten. Its functions
/// throw `IoError` where the file system refuses.
class OutputFile {
 public:
  /// Creates the file, which must not exist. Error messages call it `name`.
  OutputFile(const std::filesystem::path& path, std::string name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(const void* bytes, size_t n);
  void overwrite(uint64_t offset, const void* bytes, size_t n);
  /// Closes the file. Errors that the system has delayed are thrown here.
  void close();

 private:
  [[noreturn]] void fail(const char* what) const;
  void write(uint64_t offset, const char* bytes, size_t n);
  int fd_ = -1;
  uint64_t at_ = 0;
  std::string name_;
};

}  // namespace underbrush
