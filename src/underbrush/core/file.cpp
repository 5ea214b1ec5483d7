#include "underbrush/core/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "underbrush/core/check.hpp"
#include "underbrush/core/temporary.hpp"

namespace underbrush {

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
  const auto refuse = [&](const char* reason) {
    if (fd_ >= 0) ::close(fd_);
    throw FormatError(name_, "", reason);
  };
  fd_ =
      ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe is refused, not waited for
  if (fd_ < 0) refuse(errno == ENOENT ? "no such file" : std::strerror(errno));
  struct stat status {};
  if (::fstat(fd_, &status) != 0) refuse(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) refuse("is a folder, expected a file");
  if (!S_ISREG(status.st_mode)) refuse("is not a regular file");
  size_ = uint64_t(status.st_size);
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::read(uint64_t offset, void* to, size_t n) const {
  char* out = static_cast<char*>(to);
  while (n > 0) {
    const ssize_t got = ::pread(fd_, out, n, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FormatError(name_, "byte " + std::to_string(offset), std::strerror(errno));
    if (got == 0) {
      throw FormatError(name_, "byte " + std::to_string(offset), "the file ends here, truncated");
    }
    out += got;
    offset += uint64_t(got);
    n -= size_t(got);
  }
}

std::string read_file(const std::filesystem::path& path, uint64_t limit) {
  const InputFile file(path);
  if (file.size() > limit) throw FormatError(file.name(), "", "too large for this kind of file");
  std::string bytes(size_t(file.size()), '\0');
  file.read(0, bytes.data(), bytes.size());
  return bytes;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

bool leads_out(const std::filesystem::path& folder, const std::filesystem::path& name) {
  const std::filesystem::path normal = name.lexically_normal();
  if (name.is_absolute() || (!normal.empty() && *normal.begin() == "..")) return true;
  std::error_code error;
  const std::filesystem::path base =
      std::filesystem::weakly_canonical(folder.empty() ? "." : folder, error);
  const std::filesystem::path full = std::filesystem::weakly_canonical(base / name, error);
  const auto end = std::mismatch(base.begin(), base.end(), full.begin(), full.end()).first;
  return error || end != base.end();
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  OutputFile file(path, path.string());
  file.append(bytes.data(), bytes.size());
  file.close();
}

OutputFile::OutputFile(const std::filesystem::path& path, std::string name)
    : name_(std::move(name)) {
  const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  make_temporary([&] { fd_ = ::open(path.c_str(), flags, 0666); });
  if (fd_ < 0) fail("cannot write");
}

OutputFile::~OutputFile() {
  if (fd_ >= 0) ::close(fd_);
}

void OutputFile::fail(const char* what) const {
  throw IoError(name_ + ": " + what + ": " + std::strerror(errno));
}

void OutputFile::append(const void* bytes, size_t n) {
  write(at_, static_cast<const char*>(bytes), n);
  at_ += n;
}

void OutputFile::overwrite(uint64_t offset, const void* bytes, size_t n) {
  write(offset, static_cast<const char*>(bytes), n);
}

void OutputFile::write(uint64_t offset, const char* bytes, size_t n) {
  while (n > 0) {
    const ssize_t done = ::pwrite(fd_, bytes, n, off_t(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail("cannot write");
    bytes += done;
    offset += uint64_t(done);
    n -= size_t(done);
  }
}

void OutputFile::close() {
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) != 0) fail("cannot write");
}

}  // namespace underbrush
