/// \file
/// There are three kinds of error: a caller's mistake, bad data from outside, and an expected
/// absence (which is a `std::optional` or an explicit miss, not an exception).
#pragma once
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

/// Underbrush: a lidar simulator learnt from logs of off-road terrain.
namespace underbrush {

/// Bad data from outside. `what()` is one line, "FILE: PLACE: REASON"; PLACE may be empty.
class FormatError : public std::runtime_error {
 public:
  FormatError(std::string_view file, std::string_view place, std::string_view reason);
  const std::string& file() const { return *file_; }
  const std::string& place() const { return *place_; }
  const std::string& reason() const { return *reason_; }

 private:
  // Shared, so that a copy of the exception cannot throw.
  std::shared_ptr<const std::string> file_, place_, reason_;
};

/// A failure of the machine at run time (disk full, no permission). `what()` is one line and names
/// the file.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Data that a function cannot work with, although nothing is wrong with their format. `what()` is
/// the reason; a program puts the file's name before it.
class DataError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// Returns `text` as one line that a terminal can show: control characters, bidirectional overrides
/// and bytes that are not UTF-8 are written as `\\xNN`, and of a text longer than `limit` bytes the
/// start and the end remain around "…".
std::string printable(std::string_view text, size_t limit = 400);
/// Returns a word of a file in quotation marks, for an error message: `printable` with at most 24
/// bytes, so that a message gives little of a file away that was read by mistake.
std::string in_quotes(std::string_view word);

/// Throws `std::invalid_argument(message)` unless `ok`. Public functions check their arguments with
/// it.
inline void require(bool ok, const char* message) {
  if (!ok) throw std::invalid_argument(message);
}
/// Throws `DataError(message)` unless `ok`.
inline void require_data(bool ok, const char* message) {
  if (!ok) throw DataError(message);
}

}  // namespace underbrush
