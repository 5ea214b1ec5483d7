/// \file
/// There are three kinds of error: a caller's mistake, bad data from outside, and an expected
/// absence (which is a `std::optional` or an explicit miss, not an exception).
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

/// Underbrush: a lidar simulator learnt from logs of off-road terrain.
namespace underbrush {

/// Bad data from outside. `what()` is one line, "FILE: PLACE: REASON"; PLACE may be empty.
class FormatError : public std::runtime_error {
 public:
  FormatError(std::string_view file, std::string_view place, std::string_view reason);
};

/// A failure of the machine at run time (disk full, no permission). `what()` is one line and names
/// the file.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws `std::invalid_argument(message)` unless `ok`. Public functions check their arguments with
/// it.
inline void require(bool ok, const char* message) {
  if (!ok) throw std::invalid_argument(message);
}

}  // namespace underbrush
