// JSON as text, so that few sources need the parser and the printer. This file is for the sources
// of modules that use JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace underbrush::io {

/// Returns JSON as text, on one line unless `indent` is at least 0. Bytes that are not UTF-8 are
/// replaced.
std::string text_of_json(const nlohmann::ordered_json& json, int indent = -1);
/// Parses JSON that the program itself wrote. Throws `std::invalid_argument`.
nlohmann::ordered_json json_of_text(const std::string& text);

}  // namespace underbrush::io
