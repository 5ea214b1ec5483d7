/// \file
/// The three kinds of error: a caller's mistake, bad data from outside, and (as `std::optional` or
/// an explicit miss) an expected absence.
#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

/// Underbrush: a lidar simulator learnt from logs of off-road terrain.
namespace underbrush {

/// Bad data from outside. `what()` is one line: "FILE: PLACE: REASON" (PLACE may be empty).
class FormatError : public std::runtime_error {
 public:
  FormatError(std::string_view file, std::string_view place, std::string_view reason);
};

/// A failure of the machine while running (disk full, no permission). One line, names the file.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws `std::invalid_argument(message)` unless `ok`: the check at a public door.
inline void require(bool ok, const char* message) {
  if (!ok) throw std::invalid_argument(message);
}

}  // namespace underbrush
