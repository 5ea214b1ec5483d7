#include "underbrush/worlds/xml_file.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

constexpr uint64_t kMostXmlBytes = uint64_t(16) << 20;

std::string line_at(const std::string& text, std::ptrdiff_t offset) {
  const size_t end = std::min(text.size(), size_t(std::max<std::ptrdiff_t>(0, offset)));
  return "line " + std::to_string(1 + std::count(text.begin(), text.begin() + long(end), '\n'));
}

}  // namespace

XmlFile::XmlFile(const fs::path& path) : path_(path), text_(read_file(path, kMostXmlBytes)) {
  const size_t type = text_.find("<!DOCTYPE");
  if (type != std::string::npos) {
    throw FormatError(path.string(), line_at(text_, long(type)), "a document type is refused");
  }
  const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
  if (!result) {
    throw FormatError(path.string(), line_at(text_, result.offset), "not well-formed XML");
  }
  if (!root()) throw FormatError(path.string(), "", "no element in it");
}

void XmlFile::fail(const pugi::xml_node& at, const std::string& reason) const {
  throw FormatError(path_.string(), line_at(text_, at.offset_debug()), reason);
}

double XmlFile::number(const pugi::xml_node& of, const char* attribute, double otherwise) const {
  const pugi::xml_attribute a = of.attribute(attribute);
  if (!a) return otherwise;
  const auto words = io::words_of(a.value());
  const auto value = words.size() == 1 ? io::number_of(words[0]) : std::nullopt;
  if (!value || !(std::abs(*value) <= 1e12)) {
    fail(of, std::string(attribute) + ": " + in_quotes(a.value()) + " is not a finite number");
  }
  return *value;
}

bool XmlFile::truth(const pugi::xml_node& of, const char* attribute, bool otherwise) const {
  const pugi::xml_attribute a = of.attribute(attribute);
  if (!a) return otherwise;
  const std::string value = a.value();
  if (value == "true" || value == "1" || value == "True") return true;
  if (value == "false" || value == "0" || value == "False") return false;
  fail(of, std::string(attribute) + ": " + in_quotes(value) + " is neither true nor false");
}

std::string XmlFile::text(const pugi::xml_node& of, const char* attribute) const {
  const pugi::xml_attribute a = of.attribute(attribute);
  if (!a || !*a.value()) fail(of, std::string("no attribute ") + attribute);
  return a.value();
}

Vec3 XmlFile::vector(const pugi::xml_node& of) const {
  const double x = number(of, "x", 0), y = number(of, "y", 0);
  return {x, y, number(of, "z", 0)};
}

Eigen::Quaterniond XmlFile::rotation(const pugi::xml_node& of) const {
  const bool local = std::string(of.attribute("rotations").value()) == "local";
  Eigen::Quaterniond all = Eigen::Quaterniond::Identity();
  for (const pugi::xml_node& rot : of.children("rot")) {
    const std::string name = text(rot, "axis");
    const size_t axis = name.size() == 1 ? std::string("xyzXYZ").find(name) : std::string::npos;
    if (axis == std::string::npos) fail(rot, "axis: must be x, y or z");
    if (!rot.attribute("angle_deg")) fail(rot, "angle_deg: missing");
    const Eigen::Quaterniond one(
        Eigen::AngleAxisd(number(rot, "angle_deg", 0) * M_PI / 180, Vec3::Unit(axis % 3)));
    all = (local ? all * one : one * all).normalized();
  }
  return all;
}

pugi::xml_node XmlFile::with_id(const char* name, const std::string& id) const {
  for (const pugi::xml_node& node : root().children(name)) {
    if (id == node.attribute("id").value()) return node;
  }
  throw FormatError(path_.string(), "",
                    std::string("no element ") + name + " with the id " + in_quotes(id));
}

void XmlFile::count_others(const pugi::xml_node& of, std::initializer_list<const char*> known,
                           std::map<std::string, size_t>& left_out) const {
  for (const pugi::xml_node& child : of.children()) {
    if (child.type() != pugi::node_element) continue;
    const std::string name = child.name();
    const auto same = [&](const char* one) { return name == one; };
    if (std::any_of(known.begin(), known.end(), same)) continue;
    ++left_out["elements " + printable(name, 40) + " in " + printable(of.name(), 40)];
  }
}

fs::path Assets::path(const fs::path& in, const std::string& name) const {
  std::string file = name.substr(0, name.find('#'));
  std::replace(file.begin(), file.end(), '\\', '/');
  bool inside = false;
  for (const fs::path& base : {beside, folder}) {
    if (base.empty() || leads_out(base, file)) continue;
    inside = true;
    if (is_file(base / file)) return base / file;
  }
  throw FormatError(in.string(), "",
                    inside ? printable(file, 100) + " is not in the folder of this file; " +
                                 (folder.empty() ? "--assets FOLDER names another one"
                                                 : "nor in that of --assets")
                           : printable(file, 100) + " leads out of the folder");
}

}  // namespace underbrush::worlds
