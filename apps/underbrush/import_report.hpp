/// \file
/// The counts of an import as JSON and as text.
#pragma once
#include <string>

#include "cli/verb.hpp"
#include "underbrush/pipeline/import_log.hpp"

namespace underbrush::app {

/// Returns what became of the log's records as JSON, and as text, in which the log that was written
/// is called `output`.
Json json_of(const pipeline::ImportReport& report);
std::string text_of(const pipeline::ImportReport& report, const std::string& output);

}  // namespace underbrush::app
