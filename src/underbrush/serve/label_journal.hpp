/// \file
/// A file to which records are only ever appended, and which survives the end of the program at any
/// moment. Layout: docs/reference/labels.md.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace underbrush::serve {

/// A journal, open for reading and appending by this process alone.
///
/// A record is on the disk (fdatasync) before `append` returns. A record that was being written
/// when the program or the machine stopped is found by its length or its checksum when the file is
/// replayed; it and whatever follows are moved to a file beside the journal, `NAME.lost`.
class LabelJournal {
 public:
  /// Opens the journal, or creates it with `header`. Throws `FormatError` where the file is no
  /// journal, its header is damaged, or another program has it open; `IoError` where the file
  /// system refuses.
  LabelJournal(const std::filesystem::path& path, const std::string& header);
  ~LabelJournal();
  LabelJournal(const LabelJournal&) = delete;
  LabelJournal& operator=(const LabelJournal&) = delete;

  /// The header that the file has: the one it was created with.
  const std::string& header() const { return header_; }
  /// Bytes of damaged records that were moved to `NAME.lost` by `replay`.
  uint64_t lost_bytes() const { return lost_; }
  uint64_t bytes() const { return end_; }
  /// Calls `visit(place, record)` for each whole record, in order; needed once, before the first
  /// `append`. What `visit` throws as `std::invalid_argument` becomes a `FormatError`.
  void replay(const std::function<void(uint64_t, std::string_view)>& visit);
  /// Appends a record and returns its place. Throws `IoError`; the journal is then as before.
  uint64_t append(std::string_view record);
  /// Reads the record at a place that `append` returned or `replay` passed.
  std::string read(uint64_t at) const;

 private:
  void open(const std::string& header);
  void keep_lost(uint64_t from, uint64_t size);
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_;
  int fd_ = -1;
  std::string header_;
  uint64_t end_ = 0, size_ = 0, lost_ = 0;  ///< `end_`: of the last whole record.
};

}  // namespace underbrush::serve
