#include "underbrush/serve/range_errors.hpp"

#include <algorithm>

#include "underbrush/core/check.hpp"
#include "underbrush/io/input.hpp"

namespace underbrush::serve {
namespace {

constexpr float kSameDirection = 0.01f;  // rad

/// Rows of a log, one chunk after the other.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& path) : input_(io::open_input(path)) {}
  /// Goes to the next row. Returns false at the end.
  bool next() {
    if (++at_ < chunk_.size()) return true;
    at_ = 0;
    return input_.beams->next(chunk_);
  }
  const BeamLog& log() const { return chunk_; }
  size_t at() const { return at_; }

 private:
  io::Input input_;
  BeamLog chunk_;
  size_t at_ = 0;
};

}  // namespace

RangeErrors::RangeErrors(const std::filesystem::path& log, const std::filesystem::path& other) {
  constexpr const char* kOthers = "the logs do not have the same beams";
  Rows a(log), b(other);
  while (a.next()) {
    require_data(b.next(), kOthers);
    const Vec3f off = a.log().direction[a.at()] - b.log().direction[b.at()];
    require_data(off.norm() < kSameDirection, kOthers);
    const bool both = a.log().is_hit(a.at()) && b.log().is_hit(b.at());
    error_m_.push_back(both ? a.log().range_m[a.at()] - b.log().range_m[b.at()] : kFalseHit);
  }
  require_data(!b.next(), kOthers);
}

std::string RangeErrors::of_nodes(const OctreeFile& octree,
                                  const std::vector<uint32_t>& nodes) const {
  std::string bytes;
  for (const uint32_t k : nodes) {
    require(k < octree.nodes().size(), "no such node");
    const OctreeNode& node = octree.nodes()[k];
    require(bytes.size() + 4ull * node.points <= size_t(16) << 20, "more than 16 MiB of errors");
    std::vector<uint32_t> rows(node.points);
    octree.read(node.at + 20ull * node.points, rows.data(), 4 * rows.size());
    for (const uint32_t row : rows) {
      const float error = error_m_.at(row);
      bytes.append(reinterpret_cast<const char*>(&error), sizeof(error));
    }
  }
  return bytes;
}

}  // namespace underbrush::serve
