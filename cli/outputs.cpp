#include "cli/outputs.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "underbrush/core/check.hpp"
#include "underbrush/io/export.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

constexpr std::streamoff kLooked = 1 << 16;  // bytes at the start and at the end of a file

/// The first stands for the name with a capital letter or without.
// Lists of objects as CSV (perception::write_object_lists).
constexpr const char* kObjectColumns = "time,available,vehicle_x,vehicle_y,vehicle_z";
// The beginning of a compact log.
constexpr const char* kCompactLog = "UBLOG\r\n";
// The last columns of tables of waveforms, and all of the waveform that `sensors echo` draws.
constexpr const char* kSignalColumns = "range_m,signal\n";
// The beginning of waveforms of all beams.
constexpr const char* kWaveforms = "UBWAVES1";
constexpr const char* kMarks[] = {"nderbrush",    io::kCsvColumns, io::kPcdFields, kSignalColumns,
                                  kObjectColumns, kCompactLog,     kWaveforms};

fs::path place_of(const fs::path& path) {
  const fs::path plain = path.filename().empty() ? path.parent_path() : path;
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(plain), error);
  return error ? fs::absolute(plain).lexically_normal() : place;
}

bool same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return place_of(a) == place_of(b) || fs::equivalent(a, b, error);
}

bool lies_in(const fs::path& inner, const fs::path& folder) {
  const fs::path a = place_of(inner), b = place_of(folder);
  return a != b && std::mismatch(b.begin(), b.end(), a.begin(), a.end()).first == b.end();
}

void check_pair(const Output& a, const Output& b) {
  if (same(a.path, b.path)) {
    throw std::invalid_argument(a.option + " and " + b.option +
                                " name the same place: " + b.path.string());
  }
  for (const auto& [inner, outer] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    if (!outer->files.empty() || !lies_in(inner->path, outer->path)) continue;
    throw std::invalid_argument(inner->option + " names a place in the folder that " +
                                outer->option + " writes: " + inner->path.string());
  }
}

// Whether the files of a folder belong together: a model, a scene or a set of primitives.
bool is_whole(const fs::path& folder) {
  const auto holds = [&](const char* manifest) { return fs::exists(folder / manifest); };
  return holds("model.json") || holds("scene.json") || holds("primitives.json");
}

void check_input(const Output& out, const fs::path& input) {
  const fs::path path = out.path;
  std::error_code error;
  const bool replaces = same(path, input) || (out.files.empty() && lies_in(input, path)) ||
                        (lies_in(path, input) && is_whole(input) && fs::exists(path, error));
  if (replaces) {
    throw std::invalid_argument(out.option + " " + path.string() + " would replace the input " +
                                input.string());
  }
}

void check_not_foreign(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || is_ours(path)) return;
  throw IoError(path.string() +
                ": cannot write: exists and was not written by underbrush; --force replaces it");
}

}  // namespace

bool is_ours(const fs::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  const auto names_us = [&](std::streamoff from) {
    std::string text(size_t(std::min(kLooked, size - from)), '\0');
    in.seekg(from);
    in.read(text.data(), std::streamsize(text.size()));
    const auto has = [&](const char* mark) { return text.find(mark) != text.npos; };
    return std::any_of(std::begin(kMarks), std::end(kMarks), has);
  };
  return size == 0 ||
         (in && (names_us(0) || names_us(std::max(std::streamoff(0), size - kLooked))));
}

void check_outputs(const std::vector<Output>& outputs, const std::vector<fs::path>& inputs,
                   bool force) {
  for (size_t k = 0; k < outputs.size(); ++k) {
    const Output& out = outputs[k];
    const fs::path path = out.path;
    if (path.empty()) continue;
    if (path == "-") throw std::invalid_argument(out.option + ": expected a path, found '-'");
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_character_file(status) || fs::is_fifo(status)) continue;
    for (size_t other = 0; other < k; ++other) {
      if (!outputs[other].path.empty()) check_pair(outputs[other], out);
    }
    for (const fs::path& input : inputs) check_input(out, input);
  }
  for (const Output& out : outputs) {
    if (force || out.path.empty()) continue;
    check_not_foreign(out.path);
    for (const std::string& file : out.files) check_not_foreign(out.path / file);
  }
}

}  // namespace underbrush::app
