#include "underbrush/serve/opened_files.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/model_file.hpp"
#include "underbrush/elements/scene_file.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/json_file.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/primitives/primitive_set.hpp"
#include "underbrush/regions/index.hpp"
#include "underbrush/worlds/read_world.hpp"

namespace underbrush::serve {
namespace fs = std::filesystem;
namespace {

constexpr int kDeepest = 4;
constexpr size_t kMostFiles = 1000;
constexpr uint64_t kMostJsonBytes = uint64_t(64) << 20;

std::optional<FileKind> kind_of_folder(const fs::path& path) {
  if (elements::is_model(path)) return FileKind::kModel;
  if (elements::is_scene(path)) return FileKind::kScene;
  if (regions::is_world(path)) {
    return regions::read_index(path).is_scene ? FileKind::kScene : FileKind::kModel;
  }
  if (primitives::is_primitive_set(path)) return FileKind::kPrimitives;
  return std::nullopt;
}

bool is_score(const fs::path& path) {
  if (fs::file_size(path) > kMostJsonBytes) return false;
  const io::JsonFile file(path);
  const io::JsonValue root = file.root();
  return root.is_object() && root.find("models") && root.find("per_range") && root.find("beams");
}

// Whether a file may be a list of edits; reading it says what is wrong with it.
bool is_manifest(const fs::path& path) {
  if (path.extension() != ".json" || !fs::is_regular_file(path)) return false;
  const io::JsonFile file(path);
  return file.root().is_object() && file.root().find("format");
}

// What a file is that was found in a folder, if it is anything.
std::optional<FileKind> kind_of_found(const fs::path& path) {
  try {
    if (worlds::is_world(path)) return FileKind::kScene;
    if (path.extension() == ".json" && is_score(path)) return FileKind::kScore;
    if (io::is_log_name(path)) {
      const io::LogReader reader(path);
      return FileKind::kLog;
    }
  } catch (const FormatError&) {  // another kind of file with that ending
  }
  return std::nullopt;
}

FileKind kind_of_named(const fs::path& path) {
  if (worlds::is_world(path)) return FileKind::kScene;
  if (path.extension() == ".json") {
    if (is_score(path)) return FileKind::kScore;
    throw FormatError(path.string(), "",
                      "neither the scores that score --json writes nor a list of edits of actors");
  }
  const io::Input input = io::open_input(path);
  if (!input.beams) {
    throw FormatError(path.string(), "",
                      "scans without beams (" + input.format + "): import it first");
  }
  return FileKind::kLog;
}

class Search {
 public:
  Search(const fs::path& base, OpenedFiles& out) : base_(fs::canonical(base)), out_(out) {
    name_ = base_.filename();
  }
  void look(const fs::path& folder, int depth) {
    std::vector<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
    std::sort(entries.begin(), entries.end());
    for (const fs::path& path : entries) visit(path, depth);
  }
  size_t others() const { return others_; }

 private:
  void visit(const fs::path& path, int depth) {
    std::error_code error;
    const fs::path full = fs::canonical(path, error);
    const std::string shown = (name_ / path.lexically_relative(base_)).string();
    const fs::path inside = error ? fs::path() : full.lexically_relative(base_);
    if (inside.empty() || *inside.begin() == "..") {
      out_.notes.push_back(printable(shown) + ": a link that leads out of the folder");
      return;
    }
    if (path.filename().string().starts_with(".")) return;
    if (out_.files.size() >= kMostFiles) return;
    const bool folder = fs::is_directory(full);
    const auto kind = folder                      ? kind_of_folder(full)
                      : fs::is_regular_file(full) ? kind_of_found(full)
                                                  : std::nullopt;
    if (kind) {
      out_.files.push_back({*kind, full, shown});
    } else if (folder && depth < kDeepest && !fs::is_symlink(path)) {
      look(path, depth + 1);
    } else {
      ++others_;
    }
  }

  fs::path base_, name_;
  OpenedFiles& out_;
  size_t others_ = 0;
};

// Names that several files share get as many of the folders above them as distinguish them.
void tell_apart(std::vector<OpenedFile>& files) {
  for (bool more = true; more;) {
    std::map<std::string, std::set<fs::path>> paths;
    for (const OpenedFile& file : files) paths[file.name].insert(file.path);
    more = false;
    for (OpenedFile& file : files) {
      if (paths[file.name].size() < 2) continue;
      const fs::path shown = file.name;
      fs::path above = file.path;
      for (const auto& part : shown) above = part.empty() ? above : above.parent_path();
      if (above.filename().empty()) continue;
      file.name = (above.filename() / file.name).string();
      more = true;
    }
  }
}

}  // namespace

std::string_view name(FileKind kind) {
  switch (kind) {
    case FileKind::kLog:
      return "log";
    case FileKind::kModel:
      return "model";
    case FileKind::kPrimitives:
      return "primitives";
    case FileKind::kScene:
      return "scene";
    case FileKind::kScore:
      break;
  }
  return "score";
}

OpenedFiles find_files(const std::vector<fs::path>& named) {
  OpenedFiles out;
  for (fs::path path : named) {
    if (is_manifest(path) && !worlds::is_world(path)) {
      if (!out.edits.list.empty()) throw FormatError(path.string(), "", "a second list of edits");
      out.edits = read_edits(path);
      path = out.edits.actors;
    }
    if (!fs::is_directory(path)) {
      const FileKind kind = kind_of_named(path);
      out.files.push_back({kind, fs::canonical(path), path.filename().string()});
      continue;
    }
    const fs::path full = fs::canonical(path);
    if (const auto kind = kind_of_folder(full)) {
      out.files.push_back({*kind, full, full.filename().string()});
      continue;
    }
    const size_t before = out.files.size();
    Search search(path, out);
    search.look(full, 1);
    if (out.files.size() == before) {
      throw FormatError(path.string(), "",
                        "no log, model, scene, set of primitives or score is in this folder");
    }
    if (search.others() > 0) {
      out.notes.push_back(printable(path.string()) + ": " + std::to_string(search.others()) +
                          " other files left out");
    }
    if (out.files.size() >= kMostFiles) {
      out.notes.push_back("only the first " + std::to_string(kMostFiles) + " files are served");
      break;
    }
  }
  tell_apart(out.files);
  return out;
}

}  // namespace underbrush::serve
