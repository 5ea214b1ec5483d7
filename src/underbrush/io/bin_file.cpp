#include <algorithm>
#include <cmath>
#include <string_view>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace {

constexpr size_t kFewest = 3, kUsual = 4, kMost = 8;
constexpr size_t kLooked = 1 << 16;  // values at the head of the file
const std::vector<std::string>& usual_names() {
  static const std::vector<std::string> kNames{"x", "y", "z", "intensity", "ring", "time"};
  return kNames;
}

/// The values of a file of 32-bit floats, little-endian.
class Values {
 public:
  explicit Values(std::string_view bytes) : bytes_(bytes) {}
  size_t size() const { return bytes_.size() / 4; }
  float at(size_t i) const { return load<float>(bytes_.data() + 4 * i); }

  /// Whether columns behind x y z hold an intensity, and a ring as a fifth.
  bool makes_sense(size_t columns) const {
    for (size_t i = 0; i < std::min(size(), kLooked) / columns * columns; ++i) {
      const float v = at(i);
      if (i % columns < 3 && std::isfinite(v) && std::abs(v) > 1e5f) return false;
      if (i % columns == 3 && !(v >= 0 && v <= 65535)) return false;
      if (i % columns == 4 && !(v >= 0 && v <= 255 && v == std::floor(v))) return false;
    }
    return true;
  }

  /// Mean difference of values a row apart, relative to their sum: small where like meets like.
  double unlikeness(size_t columns) const {
    const size_t n = std::min(size(), kLooked);
    double sum = 0;
    size_t used = 0;
    for (size_t i = columns; i < n; ++i) {
      const double a = double(at(i - columns)), b = double(at(i));
      if (!std::isfinite(a) || !std::isfinite(b)) continue;
      sum += std::abs(a - b) / (std::abs(a) + std::abs(b) + 1e-3);
      ++used;
    }
    return used > 0 ? sum / double(used) : 1;
  }

 private:
  std::string_view bytes_;
};

/// A number of columns that is not ours to name and fits clearly better than `best`; 0 for none.
size_t other_columns(const Values& values, double best, double clear) {
  for (const size_t k : {3, 7, 8}) {
    if (values.size() % k == 0 && values.unlikeness(k) < clear * best) return k;
  }
  return 0;
}

/// Tells the number of columns from the values: four, unless another number fits and four does not.
size_t columns_of(const std::string& file, const Values& values) {
  constexpr size_t kEnough = 200;  // values; fewer tell nothing
  constexpr double kClear = 0.85;  // of the next best unlikeness
  std::vector<std::pair<double, size_t>> fit;
  for (size_t k = kUsual; k <= 6; ++k) {
    if (values.size() % k == 0 && values.makes_sense(k)) fit.emplace_back(values.unlikeness(k), k);
  }
  std::sort(fit.begin(), fit.end());
  const bool few = values.size() < kEnough;
  const double best = fit.empty() ? values.unlikeness(kUsual) : fit[0].first;
  if (const size_t other = few ? 0 : other_columns(values, best, kClear)) {
    throw FormatError(
        file, "",
        std::to_string(other) + " columns of floats: name them, as in --columns x,y,z,intensity");
  }
  if (few || fit.empty()) {
    if (values.size() % kUsual == 0) return kUsual;
  } else if (fit.size() == 1 || fit[0].first < kClear * fit[1].first) {
    return fit[0].second;
  }
  if (few || fit.empty()) {
    throw FormatError(file, "byte " + std::to_string(values.size() / kUsual * 16),
                      "a point is 16 bytes, the file ends inside one: truncated, or not of 4 "
                      "columns; then name them, as in --columns x,y,z,intensity,ring");
  }
  throw FormatError(file, "",
                    std::to_string(fit[0].second) + " or " + std::to_string(fit[1].second) +
                        " columns of floats: name them, as in --columns x,y,z,intensity");
}

}  // namespace

Table read_bin(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const std::string bytes = read_file(path);
  const Values values(bytes);
  size_t columns = names.size();
  if (columns == 0) {
    if (bytes.size() % 4 != 0) {
      throw FormatError(path.string(), "byte " + std::to_string(bytes.size() / 16 * 16),
                        "a value is 4 bytes, the file ends inside one: truncated");
    }
    columns = columns_of(path.string(), values);
  }
  if (columns < kFewest || columns > kMost) {
    throw FormatError(path.string(), "",
                      "--columns names 3 to 8 columns, as in x,y,z,intensity,ring, not " +
                          std::to_string(columns) + " ('" + printable(names[0]) + "'...)");
  }
  if (bytes.size() % (4 * columns) != 0) {
    throw FormatError(
        path.string(), "byte " + std::to_string(bytes.size()),
        "its size is no multiple of " + std::to_string(columns) + " columns of 4 bytes: truncated");
  }
  Table table;
  for (size_t c = 0; c < columns; ++c) {
    std::vector<float> column(bytes.size() / (4 * columns));
    for (size_t i = 0; i < column.size(); ++i) column[i] = values.at(i * columns + c);
    table.columns.emplace_back(names.empty() ? usual_names()[c] : names[c], std::move(column));
  }
  if (names.empty() && columns != kUsual) {
    std::string all;
    for (size_t c = 0; c < columns; ++c) all += " " + usual_names()[c];
    table.notes.push_back("the .bin file has " + std::to_string(columns) + " columns, taken to be" +
                          all + " (--columns names others)");
  }
  return table;
}

}  // namespace underbrush::io
