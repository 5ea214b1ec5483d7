/// \file
/// The files that a server was started for, and nothing else that it could read.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/serve/edit_list.hpp"

namespace underbrush::serve {

/// The kind of a file.
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
  std::vector<std::string> notes;  ///< The files left out and the reasons, one line each.
  GivenEdits edits;                ///< The list of edits that was named.
};

/// Finds the files to serve: each of `named` is a log, a score's JSON, or the folder of a model, a
/// set of primitives or a scene; else a folder of these, which is searched to a depth of four. A
/// link in such a folder that leads out of it is left out. A list of edits stands for the folder of
/// its actors. Throws `FormatError` where a named file is none of these, a named folder holds none,
/// or a second list is named, and as `read_edits` does. No file is read whole but the list and its
/// actors.
OpenedFiles find_files(const std::vector<std::filesystem::path>& named);

}  // namespace underbrush::serve
