#include "underbrush/io/log_layout.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::io {
namespace {

using Json = nlohmann::ordered_json;
constexpr size_t kLineLength = 200;  // Some readers have short line buffers.

// CSIRO's reader takes any line with one of these words for the property of that name.
constexpr std::array<std::string_view, 2> kTrapWords = {"time", "intensity"};

std::string compact(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

// Replaces these words in JSON, where they only occur inside strings and \u0069 means i.
std::string without_traps(std::string text) {
  for (const std::string_view word : kTrapWords) {
    for (size_t at; (at = text.find(word)) != std::string::npos;) {
      text.replace(at + word.find('i'), 1, "\\u0069");
    }
  }
  return text;
}

std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string scan_line(const ScanInfo& scan) {
  const Pose& p = scan.world_from_sensor;
  std::string line = "comment underbrush scan " + std::to_string(scan.scan);
  for (const double v : {scan.time_s, p.translation.x(), p.translation.y(), p.translation.z(),
                         p.rotation.x(), p.rotation.y(), p.rotation.z(), p.rotation.w()}) {
    line.append(1, ' ').append(number(v));
  }
  return line + "\n";
}

/// Parses the comments of a header.
class CommentReader {
 public:
  explicit CommentReader(const std::string& file) : file_(file) {}

  void take(std::string_view comment) {
    constexpr std::string_view kMark = "underbrush ";
    if (comment.substr(0, kMark.size()) != kMark) return;
    comment.remove_prefix(kMark.size());
    const size_t space = std::min(comment.find(' '), comment.size());
    const std::string_view key = comment.substr(0, space);
    const std::string_view value = comment.substr(std::min(space + 1, comment.size()));
    if (key == "log") {
      take_log(value);
    } else if (key == "scan") {
      take_scan(value);
    } else if (key == "provenance") {
      provenance_ += value;
    } else if (key == "sensor") {
      sensor_file_ += value;
    } else if (key == "column") {
      take_column(value);
    }
  }

  LogComments finish() {
    if (!sensor_file_.empty()) {
      const std::optional<Json> json = json_if_valid(sensor_file_);
      if (!json || !json->is_string()) fail("sensor", "damaged");
      out_.info.sensor_file = json->get<std::string>();
    }
    if (!provenance_.empty()) {
      const std::optional<Json> json = json_if_valid(provenance_);
      if (!json) fail("provenance", "not JSON");
      out_.provenance = text_of_json(*json);
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const char* what, const char* reason) const {
    throw FormatError(file_, std::string("comment underbrush ") + what, reason);
  }

  void take_log(std::string_view text) try {
    const std::optional<Json> found = json_if_valid(std::string(text));
    if (!found) fail("log", "damaged");
    const Json& json = *found;
    LogInfo& info = out_.info;
    info.sensor = json.at("sensor");
    info.min_range_m = json.at("min_range_m");
    info.max_range_m = json.at("max_range_m");
    info.has_misses = json.at("has_misses");
    info.deskewed = json.at("deskewed");
    info.classes = json.value("classes", "");
    if (json.contains("element_classes")) json.at("element_classes").get_to(info.element_classes);
    out_.colours = json.at("colours");
    if (!(info.max_range_m > info.min_range_m && info.min_range_m >= 0 &&
          info.max_range_m >= kMinRange && info.max_range_m < kMaxCoordinate)) {
      fail("log", "minimum and maximum range make no sense");
    }
    out_.ours = true;
  } catch (const Json::exception&) {
    fail("log", "damaged");
  }

  void take_scan(std::string_view text) {
    ScanInfo scan;
    double v[8];
    const char* at = text.data();
    const char* const end = at + text.size();
    auto result = std::from_chars(at, end, scan.scan);
    for (double& value : v) {
      if (result.ec != std::errc() || result.ptr == end) fail("scan", "expected 9 numbers");
      result = std::from_chars(result.ptr + 1, end, value);
      if (result.ec == std::errc() && !std::isfinite(value)) fail("scan", "not finite");
    }
    if (result.ec != std::errc() || result.ptr != end) fail("scan", "expected 9 numbers");
    scan.time_s = v[0];
    scan.world_from_sensor.translation = {v[1], v[2], v[3]};
    scan.world_from_sensor.rotation = Eigen::Quaterniond(v[7], v[4], v[5], v[6]);
    if (!(std::abs(scan.world_from_sensor.rotation.norm() - 1) < 1e-6)) {
      fail("scan", "the quaternion's length is not 1");
    }
    out_.info.scans.push_back(scan);
  }

  void take_column(std::string_view text) {
    const size_t space = text.rfind(' ');
    if (space == std::string_view::npos) fail("column", "expected NAME TYPE");
    const std::string name(text.substr(0, space)), type(text.substr(space + 1));
    if (type != "char" && type != "short") fail("column", "unknown type");
    out_.narrow[name] = type == "char" ? ValueType::kI8 : ValueType::kI16;
  }

  const std::string& file_;
  LogComments out_;
  std::string provenance_, sensor_file_;
};

/// Blanks behind a number change nothing in JSON.
std::string range_text(double range_m, bool padded) {
  constexpr size_t kWidest = 24;
  std::string text = compact(range_m);
  if (padded && text.size() < kWidest) text.resize(kWidest, ' ');
  return text;
}

}  // namespace

std::string text_from_comments(const LogComments& comments) {
  const LogInfo& info = comments.info;
  const auto padded = [](bool b) { return b ? "true " : "false"; };
  std::string text = "comment underbrush log {\"sensor\":";
  text += without_traps(compact(info.sensor)) + ",\"min_range_m\":" + compact(info.min_range_m) +
          ",\"max_range_m\":" + range_text(info.max_range_m, comments.pad_range) +
          ",\"has_misses\":" + padded(info.has_misses) + ",\"deskewed\":" + padded(info.deskewed) +
          ",\"colours\":" + padded(comments.colours);
  if (!info.classes.empty()) text += ",\"classes\":" + without_traps(compact(info.classes));
  if (!info.element_classes.empty()) {
    text += ",\"element_classes\":" + without_traps(compact(info.element_classes));
  }
  text += "}\n";
  for (const ScanInfo& scan : info.scans) text += scan_line(scan);
  for (const auto& [name, type] : comments.narrow) {
    text += "comment underbrush column " + name + " " + ply_name(type) + "\n";
  }
  if (!info.sensor_file.empty()) {
    const std::string line = without_traps(compact(info.sensor_file));
    for (size_t at = 0; at < line.size(); at += kLineLength) {
      text += "comment underbrush sensor " + line.substr(at, kLineLength) + "\n";
    }
  }
  if (comments.provenance.empty()) return text;
  const std::string line = without_traps(compact(json_of_text(comments.provenance)));
  for (size_t at = 0; at < line.size(); at += kLineLength) {
    text += "comment underbrush provenance " + line.substr(at, kLineLength) + "\n";
  }
  return text;
}

LogComments comments_from_header(const std::string& file, const PlyHeader& header) {
  CommentReader reader(file);
  for (const std::string& comment : header.comments) reader.take(comment);
  return reader.finish();
}

bool is_fixed_column(const std::string& name) {
  constexpr std::array<std::string_view, 19> kNames = {
      "x",   "y",     "z",    "time",  "nx",   "ny",   "nz",     "rayx",  "rayy",     "rayz",
      "red", "green", "blue", "alpha", "ring", "scan", "packet", "flags", "remission"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

std::string stored_name(const std::string& name) {
  std::vector<bool> escape(name.size(), false);
  for (size_t i = 0; i < name.size(); ++i) {
    escape[i] = name[i] <= ' ' || name[i] >= 127 || name[i] == '%';
  }
  for (const std::string_view word : kTrapWords) {
    for (size_t at = 0; (at = name.find(word, at)) != std::string::npos; ++at) {
      escape[at + word.find('i')] = true;
    }
  }
  // Older versions of CSIRO's reader compare only the beginning of the name.
  for (const char* beginning : {"x", "nx", "rayx", "red"}) {
    if (name.rfind(beginning, 0) == 0) escape[0] = true;
  }
  if (!name.empty() && is_fixed_column(name)) escape[0] = true;
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    char code[4] = {name[i]};
    if (escape[i]) std::snprintf(code, sizeof code, "%%%02X", unsigned(uint8_t(name[i])));
    out += code;
  }
  return out;
}

std::string name_from_stored(const std::string& stored) {
  std::string out;
  for (size_t i = 0; i < stored.size(); ++i) {
    unsigned code = 0;
    const char* at = stored.data() + i + 1;
    if (stored[i] == '%' && i + 2 < stored.size() &&
        std::from_chars(at, at + 2, code, 16).ptr == at + 2) {
      out += char(code);
      i += 2;
    } else {
      out += stored[i];
    }
  }
  return out;
}

}  // namespace underbrush::io
