#include "underbrush/serve/range_errors.hpp"

#include <cmath>
#include <utility>

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
    while (input_.beams->next(chunk_)) {
      if (!chunk_.empty()) return true;
    }
    chunk_ = {};
    return false;
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
  std::pair<uint32_t, uint32_t> packet;
  size_t begin = 0;  // of the packet
  while (a.next()) {
    require_data(b.next(), kOthers);
    const size_t i = a.at(), k = b.at();
    const Vec3f off = a.log().direction[i] - b.log().direction[k];
    require_data(off.norm() < kSameDirection, kOthers);
    const std::pair<uint32_t, uint32_t> own(a.log().scan[i], a.log().packet[i]);
    if (own != packet) {
      close_packet(begin);
      begin = error_m_.size();
      packet = own;
    }
    const bool both = a.log().is_hit(i) && b.log().is_hit(k);
    error_m_.push_back(both ? a.log().range_m[i] - b.log().range_m[k] : kFalseHit);
  }
  close_packet(begin);
  require_data(!b.next(), kOthers);
}

// Gives the rows from `begin` on the error of their packet.
void RangeErrors::close_packet(size_t begin) {
  double sum = 0;
  size_t n = 0;
  for (size_t row = begin; row < error_m_.size(); ++row) {
    if (error_m_[row] == kFalseHit) continue;
    sum += double(std::abs(error_m_[row]));
    ++n;
  }
  packet_error_m_.resize(error_m_.size(), n > 0 ? float(sum / double(n)) : kFalseHit);
}

std::string RangeErrors::of_nodes(const OctreeFile& octree,
                                  const std::vector<uint32_t>& nodes) const {
  std::string bytes;
  std::vector<uint32_t> rows;
  std::vector<float> errors;
  for (const uint32_t k : nodes) {
    require(k < octree.nodes().size(), "no such node");
    const OctreeNode& node = octree.nodes()[k];
    require(bytes.size() + 8ull * node.points <= size_t(16) << 20, "more than 16 MiB of errors");
    rows.resize(node.points);
    octree.read(node.at + 20ull * node.points, rows.data(), 4 * rows.size());
    errors.clear();
    for (const uint32_t row : rows) {
      require_data(row < error_m_.size(), "the log has changed since its octree was built");
      errors.insert(errors.end(), {error_m_[row], packet_error_m_[row]});
    }
    bytes.append(reinterpret_cast<const char*>(errors.data()), sizeof(float) * errors.size());
  }
  return bytes;
}

}  // namespace underbrush::serve
