/// \file
/// The verb `osi`: traces of the Open Simulation Interface that are recorded, replayed and
/// converted.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/osi/osi_options.hpp"
#include "underbrush/osi/record.hpp"

namespace underbrush::pipeline {

/// Writes the scans of a log as a trace of SensorViews, with the true objects of the options.
/// Throws as `osi::record_log` and the readers do.
osi::RecordCounts record_trace(const std::filesystem::path& log,
                               const std::filesystem::path& output, const osi::OsiOptions& options,
                               const std::string& provenance);

/// The numbers of messages that a chain processed, of lists of objects and of objects in them, of
/// rays and their returns, and of echoes, and its time.
struct ReplayCounts {
  size_t messages = 0, lists = 0, objects = 0, rays = 0, returns = 0, echoes = 0;
  size_t others = 0;  ///< Moving objects of the ground truth beside the host, of all messages.
  double seconds = 0;
};

/// Runs a chain on the messages of a trace, and writes a trace of SensorData or lists of objects,
/// by the extension of `output`. Throws as `osi::Replay` does.
ReplayCounts replay_trace(const std::filesystem::path& trace, const std::filesystem::path& output,
                          const osi::OsiOptions& options, const std::string& provenance);

/// The size of a conversion: a log's rows and scans, or lists and their objects.
struct ConvertCounts {
  bool is_log = false;
  size_t rows = 0, scans = 0, lists = 0, objects = 0;
};

/// Converts SensorViews to a log (.ply, .ublog), or lists of objects from one format to another, by
/// the extensions. Throws `FormatError`, and `std::invalid_argument` for other extensions.
ConvertCounts convert_trace(const std::filesystem::path& input, const std::filesystem::path& output,
                            const osi::OsiOptions& options, const std::string& provenance);

}  // namespace underbrush::pipeline
