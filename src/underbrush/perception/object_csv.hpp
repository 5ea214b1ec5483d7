/// \file
/// Lists of objects as CSV. This file is internal to the module.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "underbrush/perception/objects.hpp"

namespace underbrush::perception {

/// Whether a column is one of the box, which each object must have.
bool is_of_box(std::string_view column);
/// The lists as the text of a CSV file.
std::string csv_of(std::span<const ObjectList> lists);
/// Reads such a file. Throws `FormatError`.
std::vector<ObjectList> read_object_csv(const std::filesystem::path& path);

/// A CSV file as words, with its columns by name.
class CsvWords {
 public:
  /// Reads a file. Throws `FormatError` where it is empty or a row has another number of cells than
  /// the first one.
  explicit CsvWords(const std::filesystem::path& path);
  size_t rows() const { return rows_; }
  /// The number of a column; nothing if there is none.
  std::optional<size_t> find(std::string_view name) const;
  /// The number of a column. Throws `FormatError` if there is none.
  size_t at(std::string_view name) const;
  std::string_view word(size_t row, size_t column) const { return cells_[row * columns_ + column]; }
  /// A finite number. Throws `FormatError`.
  double number(size_t row, size_t column) const;
  /// A whole number in [0, 2⁵³]. Throws `FormatError`.
  uint64_t count(size_t row, size_t column) const;
  /// A class. Throws `FormatError` where the name is unknown.
  ObjectClass label(size_t row, size_t column) const;
  [[noreturn]] void fail(size_t row, const std::string& reason) const;

 private:
  std::string path_, text_;
  std::vector<std::string_view> names_, cells_;
  std::vector<size_t> line_;
  size_t columns_ = 0, rows_ = 0;
};

}  // namespace underbrush::perception
