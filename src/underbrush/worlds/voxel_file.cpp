#include "underbrush/worlds/voxel_file.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::worlds {
namespace fs = std::filesystem;
namespace {

using Words = std::vector<std::string_view>;
constexpr uint64_t kMostBytes = uint64_t(1) << 31;

/// The state of reading a .vox file line by line.
class VoxelReader {
 public:
  explicit VoxelReader(const fs::path& path) : path_(path) {}

  void take(size_t line, std::string_view content) {
    place_ = "line " + std::to_string(line);
    const Words words = io::words_of(content);
    if (line == 1) {
      if (words.size() < 2 || words[0] != "VOXEL" || words[1] != "SPACE") {
        fail("not AMAPVox: the first line is not VOXEL SPACE");
      }
      return;
    }
    if (words.empty()) return;
    if (words[0].starts_with('#')) return header(std::string(content));
    if (columns_.empty()) return names(words);
    row(words);
  }

  VoxelFile finish() {
    if (columns_.empty()) throw FormatError(path_.string(), "", "no line with names of columns");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw FormatError(path_.string(), place_, reason);
  }

  /// Takes what follows each #KEY: of a header line.
  void header(const std::string& content) {
    for (size_t at = content.find('#'); at != std::string::npos;) {
      const size_t next = content.find('#', at + 1);
      const std::string entry =
          content.substr(at + 1, next == std::string::npos ? next : next - at - 1);
      const size_t colon = entry.find(':');
      if (colon != std::string::npos) field(entry.substr(0, colon), entry.substr(colon + 1));
      at = next;
    }
  }

  void field(const std::string& key, const std::string& value) {
    if (key == "lad_type") {
      const Words words = io::words_of(value);
      if (!words.empty()) out_.leaf_angles = printable(words[0], 40);
    } else if (key == "min_corner" || key == "max_corner" || key == "split") {
      const Words words = io::words_of(value);
      if (words.size() < 3) fail(key + ": needs three values");
      for (size_t d = 0; d < 3; ++d) {
        const auto number = io::number_of(words[d]);
        if (!number || !(std::abs(*number) <= 1e9))
          fail(key + ": " + in_quotes(words[d]) + " is not a finite number");
        if (key == "min_corner") low_[d] = *number;
        if (key == "max_corner") high_[d] = *number;
        if (key != "split") continue;
        if (!(*number >= 1 && *number <= 1e6) || *number != std::floor(*number)) {
          fail("split: " + in_quotes(words[d]) + " is not a whole number from 1 to 1000000");
        }
        out_.split[d] = uint32_t(*number);
      }
      ++fields_[key];
    }
  }

  void names(const Words& words) {
    for (const char* key : {"min_corner", "max_corner", "split"}) {
      if (!fields_.count(key)) fail(std::string("no #") + key + " in the header");
    }
    for (size_t d = 0; d < 3; ++d) {
      out_.side_m[Eigen::Index(d)] = (high_[d] - low_[d]) / out_.split[d];
      out_.low[Eigen::Index(d)] = low_[d];
      if (!(out_.side_m[Eigen::Index(d)] > 1e-6)) fail("max_corner: does not lie above min_corner");
    }
    for (const char* wanted : {"i", "j", "k"}) columns_.push_back(column(words, wanted));
    size_t density = words.size();
    for (const char* wanted : {"PadBVTotal", "pad", "PAD"}) {
      if (density == words.size()) density = index_of(words, wanted);
    }
    if (density == words.size()) fail("no column PadBVTotal, pad or PAD");
    columns_.push_back(density);
  }

  static size_t index_of(const Words& words, std::string_view wanted) {
    return size_t(std::find(words.begin(), words.end(), wanted) - words.begin());
  }
  size_t column(const Words& words, const char* wanted) const {
    const size_t at = index_of(words, wanted);
    if (at == words.size()) fail(std::string("no column ") + wanted);
    return at;
  }

  void row(const Words& words) {
    std::array<uint32_t, 3> cell{};
    for (size_t d = 0; d < 3; ++d) {
      const auto number =
          columns_[d] < words.size() ? io::number_of(words[columns_[d]]) : std::nullopt;
      if (!number || !(*number >= 0 && *number < out_.split[d]) || *number != std::floor(*number)) {
        fail("the numbers of a voxel are missing or outside the grid");
      }
      cell[d] = uint32_t(*number);
    }
    const auto density =
        columns_[3] < words.size() ? io::number_of(words[columns_[3]]) : std::nullopt;
    if (!density) fail("no plant area density");
    if (!std::isfinite(*density)) {
      ++out_.left_out["voxels without a plant area density"];
      return;
    }
    if (!(*density >= 0 && *density <= 1e6)) {
      ++out_.left_out["voxels whose plant area density is negative or beyond 1e6"];
      return;
    }
    out_.cell.push_back(cell);
    out_.area_density_per_m.push_back(*density);
  }

  fs::path path_;
  std::string place_;
  std::array<double, 3> low_{}, high_{};
  std::map<std::string, int> fields_;
  std::vector<size_t> columns_;  // Of i, j, k and the density.
  VoxelFile out_;
};

Vec3 corner_of(const VoxelFile& v, size_t k) {
  const auto& c = v.cell[k];
  return v.low + v.side_m.cwiseProduct(Vec3(c[0], c[1], c[2]));
}

}  // namespace

VoxelFile read_voxels(const fs::path& path) {
  const std::string text = read_file(path, kMostBytes);
  VoxelReader reader(path);
  io::for_each_line(text,
                    [&](size_t line, std::string_view content) { reader.take(line, content); });
  if (text.empty()) throw FormatError(path.string(), "", "empty");
  return reader.finish();
}

std::vector<elements::Ellipsoid> ellipsoids_of(const VoxelFile& v, const Vec3& offset) {
  constexpr double kProjection = 0.5;
  const double within = 1 - std::exp(-0.5 * kVoxelTau * kVoxelTau);
  const double density = 8 * kProjection / (std::pow(2 * M_PI, 1.5) * within);
  const Vec3 variance = (0.5 * v.side_m).array().square();
  std::vector<elements::Ellipsoid> out;
  for (size_t k = 0; k < v.cell.size(); ++k) {
    if (!(v.area_density_per_m[k] > 0)) continue;
    elements::Ellipsoid& e = out.emplace_back();
    e.mean = (corner_of(v, k) + 0.5 * v.side_m - offset).cast<float>();
    e.covariance = {float(variance.x()), 0, 0, float(variance.y()), 0, float(variance.z())};
    e.density_per_m = float(density * v.area_density_per_m[k]);
  }
  return out;
}

io::MeshScene cubes_of(const VoxelFile& v) {
  constexpr uint32_t kFaces[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                      {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                      {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  io::MeshScene mesh;
  for (size_t k = 0; k < v.cell.size(); ++k) {
    const auto first = uint32_t(mesh.vertices.size());
    const Vec3 low = corner_of(v, k);
    for (uint32_t c = 0; c < 8; ++c) {
      mesh.vertices.push_back(low + v.side_m.cwiseProduct(Vec3(c & 1, c >> 1 & 1, c >> 2)));
    }
    for (const auto& f : kFaces) mesh.add({first + f[0], first + f[1], first + f[2]}, {});
  }
  return mesh;
}

}  // namespace underbrush::worlds
