/// \file
/// JSON files read with errors that name the file and the place in it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/core/ray.hpp"

namespace underbrush::io {

/// A value in a JSON file. Its functions throw a `FormatError` where the value is not as expected,
/// with its place, such as "objects[3].box_m".
class JsonValue {
 public:
  /// Throws `FormatError` with this value's place.
  [[noreturn]] void fail(std::string_view reason) const;
  const std::filesystem::path& file() const { return *file_; }

  /// Returns a member of an object; it must exist.
  JsonValue at(const char* member) const;
  /// Returns a member of an object, if it exists.
  std::optional<JsonValue> find(const char* member) const;
  /// Throws if the value is no object or has a member that is not among `known`.
  void check_members(std::initializer_list<const char*> known) const;

  bool is_null() const;
  bool is_object() const;
  double number() const;  ///< A finite number.
  /// Returns a whole number in [0, most].
  uint64_t count(uint64_t most = uint64_t(1) << 53) const;
  bool boolean() const;
  /// Returns a text; `what` names the expected value in an error.
  std::string text(const char* what = "a text") const;
  Vec3 vector() const;                            ///< A list of three finite numbers.
  std::vector<double> numbers() const;            ///< A list of finite numbers.
  std::vector<JsonValue> values() const;          ///< The values of a list.
  std::vector<std::string> member_names() const;  ///< The names in an object.
  /// Returns the value as JSON, on one line.
  std::string dump() const;
  /// Returns the path of a file or folder that the text names, relative to the folder of this JSON
  /// file. Unless `outside`, a path that leads out of that folder (absolute, by "..", or by a
  /// symbolic link) is refused, because the folder may come from somebody else; the error ends with
  /// `advice`.
  std::filesystem::path path(bool outside = false, const char* advice = "") const;

 private:
  friend class JsonFile;
  /// `value` is a `nlohmann::ordered_json`.
  JsonValue(const std::filesystem::path& file, std::string place, const void* value)
      : file_(&file), place_(std::move(place)), value_(value) {}
  [[noreturn]] void expected(const char* what) const;

  const std::filesystem::path* file_;
  std::string place_;
  const void* value_;
};

/// A JSON file in memory; it must outlive its values.
class JsonFile {
 public:
  /// Reads `path`. Throws `FormatError` if it cannot be read or is not JSON (then with the line).
  explicit JsonFile(const std::filesystem::path& path);
  /// Takes `text` as the content of a file of this path. Throws `FormatError` if it is not JSON.
  JsonFile(const std::filesystem::path& path, const std::string& text);
  ~JsonFile();
  JsonFile(const JsonFile&) = delete;
  JsonFile& operator=(const JsonFile&) = delete;

  JsonValue root() const;
  /// Returns `root()` of a manifest: an object whose member `format` is `format` and whose
  /// `version` is at most `newest`. `what` names the expected kind of file in the error, such as
  /// "an underbrush model".
  JsonValue manifest(const char* format, uint64_t newest, const char* what) const;

 private:
  std::filesystem::path path_;
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace underbrush::io
