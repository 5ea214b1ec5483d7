// What the manifests of our folders and files (model.json, scene.json, primitives.json,
// annotations) have in common, for the sources that read them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "underbrush/core/check.hpp"

namespace underbrush::elements {

/// Throws `FormatError` unless the manifest says `format`; `what` says in words what it is not.
inline void check_format(const std::filesystem::path& file, const nlohmann::ordered_json& said,
                         const char* format, const char* what) {
  if (said != format) throw FormatError(file.string(), "format", std::string("not ") + what);
}

/// Throws `FormatError` for a version newer than `newest`.
inline void check_version(const std::filesystem::path& file, int64_t version, int newest) {
  if (version <= newest) return;
  throw FormatError(file.string(), "version",
                    std::to_string(version) + " is newer than this program reads (" +
                        std::to_string(newest) + ")");
}

/// Both, of a manifest that must have the members `format` and `version`.
inline void check_manifest(const std::filesystem::path& file, const nlohmann::ordered_json& j,
                           const char* format, int newest, const char* what) {
  check_format(file, j.at("format"), format, what);
  check_version(file, j.at("version").get<int>(), newest);
}

}  // namespace underbrush::elements
