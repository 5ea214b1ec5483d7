/// \file
/// The files of a folder of scans, in order, and what their names say.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace underbrush::io {

/// The file of a scan.
struct ScanFile {
  std::filesystem::path path;
  std::filesystem::path labels;  ///< SemanticKITTI .label file; empty if there is none.
  uint32_t frame = 0;            ///< From the name, or else the position in the order of names.
  std::optional<double> time_s;  ///< s; from the name.
  /// The only number that differs from name to name, where names are more than a number.
  std::optional<uint32_t> number;
};

/// Returns a file's name without its extension, also without .gz behind it.
std::string scan_stem(const std::filesystem::path& path);

/// Describes one file. Frame number and time come from its name, as `list_scans` reads them; else
/// they are 0 and none.
ScanFile scan_file(const std::filesystem::path& path);

/// Lists the point files of a folder, packed by gzip or not, in the order of the numbers in their
/// names. Hidden files, whose names begin with a dot, are none: macOS keeps its attributes there,
/// as "._NAME". A name of digits below 10⁹ is a frame number. A name has a time where there is in
/// it a date of 13 digits (ms), 16 (µs), or 18 and 19 (ns), or SECONDS.FRACTION, or
/// SECONDS_FRACTION, whose fraction is in ms, µs or ns where the longest one of the folder has 3, 6
/// or 9 digits. Files whose names are unlike those of most are left out, with a line in `notes`.
/// Throws `FormatError` where there is no file, a number occurs twice, or frame numbers are among
/// as many other names.
std::vector<ScanFile> list_scans(const std::filesystem::path& folder,
                                 std::vector<std::string>& notes);

}  // namespace underbrush::io
