#include "underbrush/serve/label_journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"

namespace underbrush::serve {
namespace {

constexpr std::string_view kMagic = "UBLABEL1";
constexpr uint64_t kMostRecord = uint64_t(1) << 31;
constexpr uint64_t kMostHeader = 1 << 16;

// CRC-32 of IEEE 802.3, as in zlib and PNG.
uint32_t crc_of(std::string_view bytes) {
  static const auto kTable = [] {
    std::array<uint32_t, 256> table{};
    for (uint32_t n = 0; n < 256; ++n) {
      uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
      table[n] = c;
    }
    return table;
  }();
  uint32_t c = 0xffffffffu;
  for (const char byte : bytes) c = kTable[(c ^ uint8_t(byte)) & 255] ^ c >> 8;
  return ~c;
}

std::string framed(std::string_view record) {
  const std::array<uint32_t, 2> frame{uint32_t(record.size()), crc_of(record)};
  std::string out(reinterpret_cast<const char*>(frame.data()), sizeof(frame));
  out += record;
  return out;
}

bool read_all(int fd, uint64_t at, void* to, size_t n) {
  char* bytes = static_cast<char*>(to);
  while (n > 0) {
    const ssize_t got = ::pread(fd, bytes, n, off_t(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    bytes += got;
    at += uint64_t(got);
    n -= size_t(got);
  }
  return true;
}

bool write_all(int fd, uint64_t at, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(fd, bytes.data(), bytes.size(), off_t(at));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    bytes.remove_prefix(size_t(put));
    at += uint64_t(put);
  }
  return true;
}

// The record at a place, if it is whole.
bool read_record(int fd, uint64_t at, uint64_t size, uint64_t most, std::string& record) {
  std::array<uint32_t, 2> frame{};
  if (size - at < sizeof(frame) || !read_all(fd, at, frame.data(), sizeof(frame))) return false;
  if (frame[0] > most || frame[0] > size - at - sizeof(frame)) return false;
  record.resize(frame[0]);
  return read_all(fd, at + sizeof(frame), record.data(), record.size()) &&
         crc_of(record) == frame[1];
}

}  // namespace

void LabelJournal::fail(const char* what) const {
  throw IoError(path_.string() + ": " + what + ": " + std::strerror(errno));
}

LabelJournal::LabelJournal(const std::filesystem::path& path, const std::string& header)
    : path_(path) {
  try {
    open(header);
  } catch (...) {
    if (fd_ >= 0) ::close(fd_);
    throw;
  }
}

LabelJournal::~LabelJournal() { ::close(fd_); }

void LabelJournal::open(const std::string& header) {
  if (!std::filesystem::exists(path_)) {
    io::write_atomically(path_, std::string(kMagic) + framed(header));
  }
  fd_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (fd_ < 0) fail("cannot open");
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    throw FormatError(path_.string(), "", "another program has these labels open");
  }
  struct stat facts {};
  if (::fstat(fd_, &facts) != 0) fail("cannot read");
  if (!S_ISREG(facts.st_mode)) throw FormatError(path_.string(), "", "not a regular file");
  size_ = uint64_t(facts.st_size);
  std::array<char, kMagic.size()> magic{};
  if (size_ < magic.size() || !read_all(fd_, 0, magic.data(), magic.size()) ||
      std::string_view(magic.data(), magic.size()) != kMagic) {
    throw FormatError(path_.string(), "header", "not a journal of labels");
  }
  if (!read_record(fd_, magic.size(), size_, kMostHeader, header_)) {
    throw FormatError(path_.string(), "header", "damaged");
  }
  end_ = magic.size() + 8 + header_.size();
}

void LabelJournal::replay(const std::function<void(uint64_t, std::string_view)>& visit) {
  std::string record;
  while (end_ < size_ && read_record(fd_, end_, size_, kMostRecord, record)) {
    try {
      visit(end_, record);
    } catch (const std::invalid_argument& e) {
      throw FormatError(path_.string(), "byte " + std::to_string(end_), e.what());
    }
    end_ += 8 + record.size();
  }
  if (end_ < size_) keep_lost(end_, size_);
}

void LabelJournal::keep_lost(uint64_t from, uint64_t size) {
  lost_ = size - from;
  const std::filesystem::path place = path_.string() + ".lost";
  const int fd =
      ::open(place.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) fail("cannot keep the damaged end");
  std::string part(size_t(std::min<uint64_t>(lost_, 1 << 20)), '\0');
  bool kept = true;
  for (uint64_t at = from; kept && at < size; at += part.size()) {
    part.resize(size_t(std::min<uint64_t>(part.size(), size - at)));
    kept = read_all(fd_, at, part.data(), part.size()) &&
           ::write(fd, part.data(), part.size()) == ssize_t(part.size());
  }
  kept = ::fsync(fd) == 0 && kept;
  ::close(fd);
  if (!kept || ::ftruncate(fd_, off_t(from)) != 0 || ::fsync(fd_) != 0) {
    fail("cannot keep the damaged end");
  }
}

uint64_t LabelJournal::append(std::string_view record) {
  require(record.size() <= kMostRecord, "too large a change");
  const uint64_t at = end_;
  if (!write_all(fd_, at, framed(record)) || ::fdatasync(fd_) != 0) {
    const int why = errno;
    if (::ftruncate(fd_, off_t(at)) != 0) errno = why;
    errno = why;
    fail("cannot write");
  }
  end_ = at + 8 + record.size();
  return at;
}

std::string LabelJournal::read(uint64_t at) const {
  std::string record;
  if (!read_record(fd_, at, end_, kMostRecord, record)) {
    throw FormatError(path_.string(), "byte " + std::to_string(at), "damaged");
  }
  return record;
}

}  // namespace underbrush::serve
