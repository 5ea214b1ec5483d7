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
constexpr size_t kEnough = 200;      // values; fewer are no evidence
const std::vector<std::string>& usual_names() {
  static const std::vector<std::string> kNames{"x", "y", "z", "intensity", "ring", "time"};
  return kNames;
}

/// Whether a number is a coordinate, an intensity, a ring or a time, judging by its size.
bool is_usual(double v) {
  constexpr double kLeast = 1e-20, kGreatest = 1e7;
  return std::isnan(v) || v == 0 || (std::abs(v) > kLeast && std::abs(v) < kGreatest);
}

/// The values of a file of 32-bit floats, little-endian.
class Values {
 public:
  explicit Values(std::string_view bytes) : bytes_(bytes) {}
  size_t size() const { return bytes_.size() / 4; }
  float at(size_t i) const { return load<float>(bytes_.data() + 4 * i); }

  /// Whether columns behind x y z hold an intensity, a ring as a fifth, and a time as a sixth.
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

  /// Throws `FormatError` where the bytes are those of other numbers.
  void check(const std::string& file) const {
    constexpr double kFew = 0.01;
    const size_t n = std::min(size(), kLooked);
    if (n < kEnough) return;
    size_t strange = 0, doubles = 0;
    for (size_t i = 0; i < n; ++i) strange += !is_usual(double(at(i)));
    for (size_t i = 0; i + 1 < n; i += 2) doubles += is_usual(load<double>(bytes_.data() + 4 * i));
    if (double(strange) < kFew * double(n)) return;
    throw FormatError(
        file, "",
        double(doubles) > (1 - kFew) * double(n / 2)
            ? "holds 64-bit floats, where a .bin file holds 32-bit ones: write it as float32"
            : "its values are no 32-bit floats, little-endian, alone: as of rows with whole "
              "numbers "
              "in them; write it as float32, or as .npy or .pcd, which name their columns");
  }

 private:
  std::string_view bytes_;
};

constexpr const char* kNameThem =
    " columns of floats: name them, as in --columns x,y,z,intensity,ring";

/// Tells the number of columns from the values: the one with which rows resemble each other most,
/// if the columns are the usual ones then. A few values are four columns.
size_t columns_of(const std::string& file, const Values& values) {
  constexpr double kClear = 0.85;  // of the next best unlikeness
  if (values.size() < kEnough) {
    if (values.size() % kUsual == 0) return kUsual;
    throw FormatError(file, "byte " + std::to_string(values.size() / kUsual * 16),
                      "a point is 16 bytes, the file ends inside one: truncated, or not of 4 "
                      "columns; then name them, as in --columns x,y,z,intensity,ring");
  }
  // Every second of rows of four columns may be more alike, as of rings that fire in turn.
  const double next_to_four =
      std::min({values.unlikeness(5), values.unlikeness(6), values.unlikeness(7)});
  const bool pairs_of_four =
      values.makes_sense(kUsual) && values.unlikeness(kUsual) < kClear * next_to_four;
  std::vector<std::pair<double, size_t>> usual, other;
  for (size_t k = kFewest; k <= kMost; ++k) {
    if (values.size() % k != 0 || (k == 2 * kUsual && pairs_of_four)) continue;
    const bool known = k >= kUsual && k <= usual_names().size() && values.makes_sense(k);
    (known ? usual : other).emplace_back(values.unlikeness(k), k);
  }
  std::sort(usual.begin(), usual.end());
  std::sort(other.begin(), other.end());
  const double best = usual.empty() ? 1 : usual[0].first;
  if (!other.empty() && other[0].first < (usual.empty() ? 1 : kClear) * best) {
    const bool clear = other.size() == 1 || other[0].first < kClear * other[1].first;
    // Four columns are x y z and an intensity of any sign.
    if (clear && other[0].second == kUsual) return kUsual;
    throw FormatError(file, "", (clear ? std::to_string(other[0].second) : "3 to 8") + kNameThem);
  }
  if (usual.empty()) {
    throw FormatError(file, "byte " + std::to_string(values.size() / kUsual * 16),
                      "a point is 16 bytes, the file ends inside one: truncated, or not of 4 "
                      "columns; then name them, as in --columns x,y,z,intensity,ring");
  }
  if (usual.size() > 1 && usual[0].first >= kClear * usual[1].first) {
    throw FormatError(
        file, "",
        std::to_string(usual[0].second) + " or " + std::to_string(usual[1].second) + kNameThem);
  }
  return usual[0].second;
}

}  // namespace

Table read_bin(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const std::string bytes = read_file(path);
  const Values values(bytes);
  size_t columns = names.size();
  values.check(path.string());
  if (columns == 0) {
    if (bytes.size() % 4 != 0) {
      throw FormatError(path.string(), "byte " + std::to_string(bytes.size() / 16 * 16),
                        "a value is 4 bytes, the file ends inside one: truncated, or of other "
                        "numbers than 32-bit floats");
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
