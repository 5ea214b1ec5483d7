/// \file
/// The readers that libFuzzer gives damaged bytes to. Each program has a table of them.
#pragma once
#include <filesystem>
#include <span>
#include <string_view>
#include <variant>

namespace underbrush {
/// Fuzzing of the readers: whatever the bytes are, a reader ends with a result, a `FormatError` or
/// a `DataError`.
namespace fuzz {

using Path = std::filesystem::path;

/// A reader. It runs in a folder of seeds, and other files of these seeds are those beside its own.
struct Reader {
  std::string_view name;
  /// The files with which the fuzzer begins, with spaces between them. The damaged bytes take the
  /// place of the first one.
  std::string_view seeds;
  /// Reads that file, or the bytes alone.
  std::variant<void (*)(const Path&), void (*)(std::string_view)> read;
};

/// The readers of this program.
std::span<const Reader> readers();

/// Writes those seeds into the present folder that are made by functions of the library.
void make_seeds();

}  // namespace fuzz
}  // namespace underbrush
