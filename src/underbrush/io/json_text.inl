// JSON as text, so that few sources need the parser and the printer. This file is for the sources
// of modules that use JSON.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace underbrush::io {

/// Returns JSON as text, on one line unless `indent` is at least 0. Bytes that are not UTF-8 are
/// replaced.
std::string text_of_json(const nlohmann::ordered_json& json, int indent = -1);
/// Parses JSON; nothing if the text is none, or nested deeper than 64 levels.
std::optional<nlohmann::ordered_json> json_if_valid(const std::string& text);
/// Throws `FormatError` with the line, as reading `file` does, if its `text` is not JSON.
void check_json(const std::filesystem::path& file, const std::string& text);
/// Parses JSON that the program itself wrote. Throws `std::invalid_argument`.
nlohmann::ordered_json json_of_text(const std::string& text);

/// Returns a number; null where it is infinite or not a number, which JSON does not have.
nlohmann::ordered_json finite_or_null(double x);

}  // namespace underbrush::io
