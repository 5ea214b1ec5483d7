/// \file
/// XML files read with errors that name the file and the line.
#pragma once
#include <filesystem>
#include <initializer_list>
#include <map>
#include <pugixml.hpp>
#include <string>

#include "underbrush/core/pose.hpp"

namespace underbrush::worlds {

/// An XML file in memory. A document type, and with it every entity of its own, is refused.
class XmlFile {
 public:
  /// Throws `FormatError` where the file cannot be read, is larger than 16 MiB, is not XML, or
  /// declares a document type.
  explicit XmlFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// The document's outermost element.
  pugi::xml_node root() const { return document_.document_element(); }

  /// Throws `FormatError` with the line of the element.
  [[noreturn]] void fail(const pugi::xml_node& at, const std::string& reason) const;
  /// Returns an attribute, or `otherwise` where there is none. Throws where it is not a finite
  /// number.
  double number(const pugi::xml_node& of, const char* attribute, double otherwise) const;
  /// Returns an attribute as a truth value: true, 1, false or 0.
  bool truth(const pugi::xml_node& of, const char* attribute, bool otherwise) const;
  /// Returns an attribute; it must be there.
  std::string text(const pugi::xml_node& of, const char* attribute) const;
  /// Returns the attributes x, y and z, each 0 where it is not there.
  Vec3 vector(const pugi::xml_node& of) const;
  /// Returns the rotation of the elements rot (axis, angle_deg) in `of`: each turns the rotation
  /// before it about the fixed axes, or, with rotations="local", about the turned ones.
  Eigen::Quaterniond rotation(const pugi::xml_node& of) const;
  /// Returns the element `name` with this id. Throws where there is none.
  pugi::xml_node with_id(const char* name, const std::string& id) const;
  /// Counts in `left_out` the child elements of `of` whose names are not among `known`.
  void count_others(const pugi::xml_node& of, std::initializer_list<const char*> known,
                    std::map<std::string, size_t>& left_out) const;

 private:
  std::filesystem::path path_;
  std::string text_;
  pugi::xml_document document_;
};

/// A name in a file of HELIOS++, FILE.xml#ID, and the folders in which FILE is looked for.
struct Assets {
  std::filesystem::path beside;  ///< The folder of the first XML file.
  std::filesystem::path folder;  ///< Another folder; may be empty.

  /// Returns the path of the file. Throws `FormatError` (of `in`) where it leads out of both
  /// folders or is in neither.
  std::filesystem::path path(const std::filesystem::path& in, const std::string& name) const;
};

}  // namespace underbrush::worlds
