/// \file
/// The report of `info` on a log.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/io/input.hpp"
#include "underbrush/pipeline/log_contents.hpp"

namespace underbrush::report {

using Json = nlohmann::ordered_json;

/// Returns the contents as JSON; `input` is the log, read to its end.
Json json_of_log(const io::Input& input, const pipeline::LogContents& contents);
/// Returns the contents as a table; `j` is the result of `json_of_log`.
std::string table_of_log(const std::string& file, const LogInfo& info,
                         const pipeline::LogContents& contents, const Json& j);

}  // namespace underbrush::report
