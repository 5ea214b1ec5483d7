/// \file
/// Files as bytes, with one clear line for everything that can go wrong.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace underbrush::io {

/// A regular file open for reading at any place; usable from several threads.
class InputFile {
 public:
  /// Throws `FormatError` if there is no such file, no permission, or it is a folder.
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  uint64_t size() const { return size_; }
  const std::string& name() const { return name_; }
  /// Fills `to` with bytes [offset, offset + n); `FormatError` where the file ends before.
  void read(uint64_t offset, void* to, size_t n) const;

 private:
  int fd_ = -1;
  uint64_t size_ = 0;
  std::string name_;
};

/// The whole file; `FormatError` as `InputFile`, and where it is larger than `limit` bytes.
std::string read_file(const std::filesystem::path& path, uint64_t limit = uint64_t(1) << 36);

/// A new file, written from the front; earlier bytes can be overwritten. `IoError` where refused.
class OutputFile {
 public:
  /// `name` is what errors call the file.
  OutputFile(const std::filesystem::path& path, std::string name);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(const void* bytes, size_t n);
  void overwrite(uint64_t offset, const void* bytes, size_t n);
  /// Completes the file; errors that the system kept back show here.
  void close();

 private:
  [[noreturn]] void fail(const char* what) const;
  void write(uint64_t offset, const char* bytes, size_t n);
  int fd_ = -1;
  uint64_t at_ = 0;
  std::string name_;
};

}  // namespace underbrush::io
