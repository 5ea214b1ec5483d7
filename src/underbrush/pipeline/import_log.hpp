/// \file
/// The verb `import`: a log of any supported format in, beams out, with misses kept or inferred.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "underbrush/io/scan_clock.hpp"
#include "underbrush/pipeline/import_options.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::pipeline {

/// The counts of the records of an imported log.
struct ImportReport {
  std::string format;
  size_t scans = 0, beams = 0;
  size_t later_returns = 0;  ///< Rows that are no first return; they are not counted as beams.
  sensor::BeamCounts beam;
  std::map<std::string, size_t> skipped;  ///< Records left out, by reason.
  std::optional<io::ScanClock> clock;
  std::vector<std::string> notes;  ///< Assumptions of the reader.
  /// There is a warning where more than 3 % of the recorded misses are lost, because hit
  /// probabilities are learnt from misses.
  std::vector<std::string> warnings;
};

/// Reads a log of any supported format. `begin` receives the description of the log, and `write`
/// its beams, chunk by chunk (a scan each for formats of scans). Whether the log has misses is
/// known at the end. `progress(done, total)` may be empty. Throws `FormatError`, also where no beam
/// is usable, and `std::invalid_argument` for options out of range or without effect.
ImportReport import_log(const std::filesystem::path& source, const ImportOptions& options,
                        const std::function<void(const LogInfo&)>& begin,
                        const std::function<void(const BeamLog&)>& write,
                        const std::function<void(size_t, size_t)>& progress = {});

}  // namespace underbrush::pipeline
