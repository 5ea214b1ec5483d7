#include "underbrush/io/json_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/core/names.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr int kDeepestJson = 64;
constexpr uint64_t kMostJson = uint64_t(1) << 31;

constexpr size_t kMostMembers = 10'000;  // of an object; finding one takes time with their number

struct TooDeep {};
struct TooMany {};

/// Functions that go through a value call themselves for each level of it. A callback of the parser
/// could count levels, but with one its time grows with the square of an array's length.
void limit_size(const std::string& text) {
  int depth = 0;
  std::array<size_t, kDeepestJson + 1> members{};  // of the object at each depth
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      in_string = !in_string;
    } else if (in_string) {
      i += c == '\\';
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) throw TooDeep();
      members[size_t(depth)] = 0;
    } else if (c == ':') {
      if (++members[size_t(depth)] > kMostMembers) throw TooMany();
    } else if (c == ']' || c == '}') {
      depth = std::max(depth - 1, 0);  // What closes more than it has opened is not JSON.
    }
  }
}

Json parsed(const fs::path& path, const std::string& text) {
  try {
    limit_size(text);
    return Json::parse(text);
  } catch (const TooDeep&) {
    throw FormatError(path.string(), "", "nested too deep");
  } catch (const TooMany&) {
    throw FormatError(path.string(), "",
                      "has an object of more than " + std::to_string(kMostMembers) + " members");
  } catch (const nlohmann::json::parse_error& e) {
    const auto end = text.begin() + ptrdiff_t(std::min(e.byte, text.size()));
    throw FormatError(path.string(),
                      "line " + std::to_string(1 + std::count(text.begin(), end, '\n')),
                      "not JSON (a NaN is none either)");
  } catch (const nlohmann::json::exception&) {  // A number beyond all bounds ends here.
    throw FormatError(path.string(), "", "not JSON: a number is too large");
  }
}

const Json& json_at(const void* value) { return *static_cast<const Json*>(value); }

}  // namespace

std::string text_of_json(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::optional<Json> json_if_valid(const std::string& text) {
  try {
    limit_size(text);
    return Json::parse(text);
  } catch (const TooDeep&) {
  } catch (const TooMany&) {
  } catch (const nlohmann::json::exception&) {
  }
  return std::nullopt;
}

void check_json(const fs::path& file, const std::string& text) { parsed(file, text); }

Json json_of_text(const std::string& text) {
  std::optional<Json> json = json_if_valid(text);
  require(json.has_value(), "a provenance is not JSON");
  return *std::move(json);
}

Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

void JsonValue::fail(std::string_view reason) const {
  throw FormatError(file_->string(), place_, reason);
}

void JsonValue::expected(const char* what) const {
  fail(std::string("expected ") + what + ", found " +
       in_quotes(json_at(value_).dump(-1, ' ', true, Json::error_handler_t::replace)));
}

JsonValue JsonValue::at(const char* name) const {
  const std::optional<JsonValue> found = find(name);
  if (!found) fail(std::string("has no member '") + name + "'");
  return *found;
}

std::optional<JsonValue> JsonValue::find(const char* name) const {
  if (!json_at(value_).is_object()) expected("an object { … }");
  const auto found = json_at(value_).find(name);
  if (found == json_at(value_).end()) return std::nullopt;
  return JsonValue(*file_, place_.empty() ? name : place_ + "." + name, &*found);
}

void JsonValue::check_members(std::initializer_list<const char*> known) const {
  for (const std::string& name : member_names()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string near = nearest_name(name, {known.begin(), known.end()});
    fail("unknown member " + in_quotes(name) +
         (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
}

bool JsonValue::is_null() const { return json_at(value_).is_null(); }

bool JsonValue::is_object() const { return json_at(value_).is_object(); }

double JsonValue::number() const {
  if (!json_at(value_).is_number() || !std::isfinite(json_at(value_).get<double>()))
    expected("a finite number");
  return json_at(value_).get<double>();
}

uint64_t JsonValue::count(uint64_t most) const {
  if (!json_at(value_).is_number_unsigned() || json_at(value_).get<uint64_t>() > most) {
    expected("a whole number from 0 on");
  }
  return json_at(value_).get<uint64_t>();
}

bool JsonValue::boolean() const {
  if (!json_at(value_).is_boolean()) expected("true or false");
  return json_at(value_).get<bool>();
}

std::string JsonValue::text(const char* what) const {
  if (!json_at(value_).is_string()) expected(what);
  return json_at(value_).get<std::string>();
}

Vec3 JsonValue::vector() const {
  if (!json_at(value_).is_array() || json_at(value_).size() != 3) expected("three numbers");
  const std::vector<double> v = numbers();
  return {v[0], v[1], v[2]};
}

std::vector<double> JsonValue::numbers() const {
  std::vector<double> out;
  for (const JsonValue& v : values()) out.push_back(v.number());
  return out;
}

std::vector<JsonValue> JsonValue::values() const {
  const Json& json = json_at(value_);
  if (!json_at(value_).is_array()) expected("a list [ … ]");
  std::vector<JsonValue> out;
  out.reserve(json_at(value_).size());
  for (size_t k = 0; k < json_at(value_).size(); ++k) {
    out.push_back(JsonValue(*file_, place_ + "[" + std::to_string(k) + "]", &json[k]));
  }
  return out;
}

std::vector<std::string> JsonValue::member_names() const {
  if (!json_at(value_).is_object()) expected("an object { … }");
  std::vector<std::string> out;
  for (const auto& [name, value] : json_at(value_).items()) out.push_back(name);
  return out;
}

std::string JsonValue::dump() const { return text_of_json(json_at(value_)); }

fs::path JsonValue::path(bool outside, const char* advice) const {
  const fs::path name = text("a path"), folder = file_->parent_path();
  if (name.empty()) expected("a path");
  if (!outside && leads_out(folder, name)) {
    fail(in_quotes(name.string()) + " leads out of the folder of this file" + advice);
  }
  return folder / name;
}

struct JsonFile::Content {
  Json json;
};

JsonFile::JsonFile(const fs::path& path) : JsonFile(path, read_file(path, kMostJson)) {}

JsonFile::JsonFile(const fs::path& path, const std::string& text)
    : path_(path), content_(std::make_unique<Content>(Content{parsed(path, text)})) {}

JsonFile::~JsonFile() = default;

JsonValue JsonFile::root() const { return JsonValue(path_, "", &content_->json); }

JsonValue JsonFile::manifest(const char* format, uint64_t newest, const char* what) const {
  JsonValue j = root();
  const JsonValue said = j.at("format");
  if (said.text() != format) said.fail(std::string("not ") + what);
  const JsonValue version = j.at("version");
  if (version.count() > newest) {
    version.fail(std::to_string(version.count()) + " is newer than this program reads (" +
                 std::to_string(newest) + ")");
  }
  return j;
}

}  // namespace underbrush::io
