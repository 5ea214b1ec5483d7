#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "studies/solid.hpp"

namespace underbrush::studies {
namespace {

using nlohmann::json;

Solid from_json(const std::string& file, const std::string& text) {
  Solid out;
  try {
    const json j = json::parse(text);
    for (const json& v : j.at("vertices")) {
      const auto xyz = v.get<std::vector<double>>();
      if (xyz.size() != 3) throw FormatError(file, "vertices", "a corner needs three numbers");
      out.vertices.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
    for (const json& face : j.at("faces")) {
      std::vector<uint32_t> corners;
      for (const json& i : face) {
        if (!i.is_number_unsigned() || i.get<uint64_t>() >= out.vertices.size())
          throw FormatError(file, "faces", "a corner that does not exist");
        corners.push_back(i.get<uint32_t>());
      }
      out.faces.push_back(std::move(corners));
    }
  } catch (const json::exception& e) {
    throw FormatError(file, "", e.what());
  }
  return out;
}

/// The corner that "7", "7/1" or "-1" means, from 0.
uint32_t obj_corner(const std::string& file, const std::string& place, std::string_view word,
                    size_t vertices) {
  long long i = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), i);
  const bool whole = end == word.data() + word.size() || *end == '/';
  if (i < 0) i += (long long)(vertices) + 1;
  if (error != std::errc() || !whole || i < 1 || i > (long long)(vertices))
    throw FormatError(file, place, "a corner that does not exist");
  return uint32_t(i - 1);
}

Solid from_obj(const std::string& file, std::istream& in) {
  Solid out;
  std::string line;
  for (size_t number = 1; std::getline(in, line); ++number) {
    const std::string place = "line " + std::to_string(number);
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3 v;
      if (!(words >> v.x() >> v.y() >> v.z()))
        throw FormatError(file, place, "a corner needs three numbers");
      out.vertices.push_back(v);
    } else if (word == "f") {
      std::vector<uint32_t> corners;
      while (words >> word) corners.push_back(obj_corner(file, place, word, out.vertices.size()));
      out.faces.push_back(std::move(corners));
    }
  }
  return out;
}

}  // namespace

Solid read_solid(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FormatError(file, "", "cannot open");
  Solid out;
  if (path.extension() == ".json") {
    out = from_json(file, {std::istreambuf_iterator<char>(in), {}});
  } else {
    out = from_obj(file, in);
  }
  if (out.faces.empty()) throw FormatError(file, "", "no face");
  try {
    out.check();
  } catch (const std::invalid_argument& e) {
    throw FormatError(file, "", e.what());
  }
  return out;
}

}  // namespace underbrush::studies
