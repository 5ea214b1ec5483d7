/// \file
/// The files that a server was started for, and nothing else that it could read.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace underbrush::serve {

/// What a file is.
enum class FileKind { kLog, kModel, kPrimitives, kScene, kScore };

/// Returns "log", "model", "primitives", "scene" or "score".
std::string_view name(FileKind kind);

/// A file or folder that is served.
struct OpenedFile {
  FileKind kind = FileKind::kLog;
  std::filesystem::path path;  ///< The path with all links resolved.
  /// The name that users see: the path relative to the file or folder that was named, with as many
  /// folders above it as distinguish the files.
  std::string name;
};

/// The files, in the order in which they were named, those of a folder by name.
struct OpenedFiles {
  std::vector<OpenedFile> files;
  std::vector<std::string> notes;  ///< What was left out and why, one line each.
};

/// Finds what to serve: each of `named` is a log, a score's JSON, or the folder of a model, a set
/// of primitives or a scene; else a folder of these, which is searched to a depth of four. A link
/// in such a folder that leads out of it is left out. Throws `FormatError` where a named file is
/// none of these or a named folder holds none, and reads no file whole.
OpenedFiles find_files(const std::vector<std::filesystem::path>& named);

}  // namespace underbrush::serve
