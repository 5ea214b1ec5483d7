/// \file
/// Lists of objects in files of any kind: CSV, JSON, or traces of OSI.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "underbrush/perception/log_truth.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::osi {

/// Throws `std::invalid_argument` where a name promises another format than those of lists.
void check_list_name(const std::filesystem::path& path);
/// Writes lists as SensorData to a trace (.osi), else as `perception::write_object_lists` does.
/// Throws what `check_list_name` throws.
void write_lists(const std::filesystem::path& path, std::span<const perception::ObjectList> lists,
                 const std::string& provenance);
/// Reads the objects of a trace: those of SensorData, or the true ones of SensorViews or
/// GroundTruths. Throws `FormatError`.
std::vector<perception::ObjectList> read_trace_lists(const std::filesystem::path& path);
/// Reads lists from a trace, or as `perception::read_object_lists` does.
std::vector<perception::ObjectList> read_lists(const std::filesystem::path& path);
/// Whether a file has lists of objects.
bool is_list_file(const std::filesystem::path& path);
/// The ground truth of a log from a file, which may be a trace.
perception::LogTruth truth_of_log(const std::filesystem::path& path, const LogInfo& log,
                                  const perception::LogTruthOptions& options);

}  // namespace underbrush::osi
