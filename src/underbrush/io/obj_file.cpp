#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/mesh_readers.hpp"
#include "underbrush/io/polygon.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

/// Returns the vertex that a corner "v", "v/t" or "v/t/n" of a face names. Numbers count from 1;
/// negative ones count back from the last vertex.
uint32_t corner(const fs::path& path, const std::string& place, std::string_view word, size_t n) {
  const auto value = number_of(word.substr(0, word.find('/')));
  const double index = !value ? 0 : *value < 0 ? double(n) + *value + 1 : *value;
  if (!(index >= 1 && index <= double(n)) || index != std::floor(index)) {
    throw FormatError(path.string(), place, in_quotes(word) + " names no vertex");
  }
  return uint32_t(index) - 1;
}

/// Returns what stands behind the first word of a line, without spaces at its ends.
std::string rest_of(std::string_view line, std::string_view first) {
  const size_t begin = line.find_first_not_of(" \t", line.find(first) + first.size());
  if (begin == std::string_view::npos) return "";
  return std::string(line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin));
}

/// Calls `f(number, line)` for each line of an OBJ or MTL file. A line that ends with a backslash
/// goes on in the next one, unless it is a comment; the number is that of its last part.
template <class F>
void for_each_joined_line(const std::string& text, F f) {
  std::string open;
  size_t last = 0;
  for_each_line(text, [&](size_t line, std::string_view content) {
    last = line;
    const size_t end = content.find_last_not_of(" \t\r"), first = content.find_first_not_of(" \t");
    const bool comment = open.empty() && first != std::string_view::npos && content[first] == '#';
    if (!comment && end != std::string_view::npos && content[end] == '\\') {
      open += content.substr(0, end);
      open += ' ';
    } else if (open.empty()) {
      f(line, content);
    } else {
      f(line, open += content);
      open.clear();
    }
  });
  if (!open.empty()) f(last, open);
}

/// The state of reading an OBJ file line by line.
class ObjReader {
 public:
  ObjReader(const fs::path& path, bool with_materials)
      : path_(path), with_materials_(with_materials) {}

  void take(size_t line, std::string_view content) {
    const auto words = words_of(content);
    if (words.empty() || words[0].starts_with('#')) return;
    if (words[0] == "v" || words[0] == "f") {
      place_ = "line " + std::to_string(line);
      if (words.size() < 4) {
        throw FormatError(path_.string(), place_,
                          "fewer than three values after " + std::string(words[0]));
      }
      return words[0] == "v" ? vertex(words) : face(words);
    }
    name(words[0], content);
  }

  MeshScene finish() { return std::move(mesh_); }

 private:
  void vertex(const std::vector<std::string_view>& words) {
    const double x = mesh_coordinate(path_, place_, words[1]);
    const double y = mesh_coordinate(path_, place_, words[2]);
    mesh_.vertices.emplace_back(x, y, mesh_coordinate(path_, place_, words[3]));
  }

  void face(const std::vector<std::string_view>& words) {
    std::vector<uint32_t> index;
    std::vector<Vec3> corners;
    for (size_t k = 1; k < words.size(); ++k) {
      index.push_back(corner(path_, place_, words[k], mesh_.vertices.size()));
      corners.push_back(mesh_.vertices[index.back()]);
    }
    for (const auto& t : triangles_of_polygon(corners)) {
      mesh_.add({index[t[0]], index[t[1]], index[t[2]]}, part_);
    }
  }

  void name(std::string_view word, std::string_view content) {
    if (word == "o" || word == "g") {
      part_.object = rest_of(content, word);
    } else if (word == "usemtl") {
      part_.material = rest_of(content, word);
    } else if (word == "mtllib") {
      if (with_materials_) add_library(rest_of(content, word));
    } else if (word == "l" || word == "p") {
      ++mesh_.left_out["lines and points"];
    } else if (word != "vt" && word != "vn" && word != "s") {
      ++mesh_.left_out["lines of other kinds"];
    }
  }

  void add_library(std::string file) {
    std::replace(file.begin(), file.end(), '\\', '/');
    if (leads_out(fs::absolute(path_).parent_path(), file)) {
      throw FormatError(path_.string(), "mtllib",
                        in_quotes(file) + " leads out of the folder of this file");
    }
    const fs::path at = path_.parent_path() / file;
    if (!is_file(at)) {
      ++mesh_.left_out["MTL files that are not there"];
      return;
    }
    for (MeshMaterial& m : read_mtl(at, mesh_.left_out)) mesh_.materials.push_back(std::move(m));
  }

  fs::path path_;
  bool with_materials_;
  std::string place_;
  MeshPart part_;
  MeshScene mesh_;
};

/// The state of reading an MTL file line by line.
class MtlReader {
 public:
  MtlReader(const fs::path& path, std::map<std::string, size_t>& left_out)
      : path_(path), left_out_(left_out) {}

  void take(size_t line, std::string_view content) {
    const auto words = words_of(content);
    if (words.empty() || words[0].starts_with('#')) return;
    place_ = "line " + std::to_string(line);
    if (words[0] == "newmtl") {
      materials_.emplace_back();
      materials_.back().name = rest_of(content, words[0]);
      return;
    }
    if (materials_.empty() || !words[0].starts_with("helios_")) return;
    if (words.size() < 2) fail("no value after " + std::string(words[0]));
    if (words[0] == "helios_reflectance") {
      materials_.back().reflectance = {{0, number(words[1], 0, 1)}};
    } else if (words[0] == "helios_classification") {
      materials_.back().classification = int(number(words[1], 0, 255));
    } else if (words[0] == "helios_isGround") {
      const std::string_view word = words[1];
      const bool ground = word == "1" || word == "true" || word == "True" || word == "TRUE";
      if (ground && !materials_.back().classification) materials_.back().classification = 2;
    } else if (words[0] == "helios_spectra") {
      spectrum(std::string(words[1]));
    } else {
      ++left_out_["MTL lines of other kinds"];
    }
  }

  std::vector<MeshMaterial> finish() { return std::move(materials_); }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(path_.string(), place_, reason);
  }

  double number(std::string_view word, double low, double high) const {
    const auto value = number_of(word);
    if (value && *value >= low && *value <= high) return *value;
    fail(in_quotes(word) + " is not a number from " + std::to_string(int(low)) + " to " +
         std::to_string(int(high)));
  }

  void spectrum(const std::string& name) {
    const fs::path folder = fs::absolute(path_).parent_path();
    if (!materials_.back().reflectance.empty()) return;  // A reflectance goes before a spectrum.
    for (const fs::path& file : {fs::path(name + ".txt"), fs::path("spectra") / (name + ".txt")}) {
      if (leads_out(folder, file)) fail(in_quotes(name) + " leads out of the folder of this file");
      if (!is_file(folder / file)) continue;
      materials_.back().reflectance = read_spectrum(folder / file);
      return;
    }
    ++left_out_["spectra that are not there"];
  }

  fs::path path_;
  std::map<std::string, size_t>& left_out_;
  std::string place_;
  std::vector<MeshMaterial> materials_;
};

}  // namespace

MeshScene read_obj(const fs::path& path, bool with_materials) {
  const std::string text = read_text(path, kMostMeshBytes);
  ObjReader reader(path, with_materials);
  for_each_joined_line(text,
                       [&](size_t line, std::string_view content) { reader.take(line, content); });
  return reader.finish();
}

std::vector<MeshMaterial> read_mtl(const fs::path& path, std::map<std::string, size_t>& left_out) {
  const std::string text = read_text(path, uint64_t(64) << 20);
  MtlReader reader(path, left_out);
  for_each_joined_line(text,
                       [&](size_t line, std::string_view content) { reader.take(line, content); });
  return reader.finish();
}

std::vector<std::pair<double, double>> read_spectrum(const fs::path& path) {
  constexpr size_t kHeader = 26;  // lines
  const std::string text = read_text(path, uint64_t(16) << 20);
  std::vector<std::pair<double, double>> pairs;
  for_each_line(text, [&](size_t line, std::string_view content) {
    const auto words = words_of(content);
    if (line <= kHeader || words.empty()) return;
    const auto wavelength = words.size() < 2 ? std::nullopt : number_of(words[0]);
    const auto percent = words.size() < 2 ? std::nullopt : number_of(words[1]);
    if (!wavelength || !percent || !(*wavelength > 0 && *wavelength < 1e3) || !(*percent <= 1e3) ||
        !(*percent >= -1e3)) {
      throw FormatError(path.string(), "line " + std::to_string(line),
                        "not a wavelength in µm and a reflectance in percent");
    }
    pairs.emplace_back(*wavelength * 1e-6, std::clamp(*percent / 100, 0.0, 1.0));
  });
  if (pairs.empty()) throw FormatError(path.string(), "", "no values behind 26 lines of header");
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace underbrush::io
