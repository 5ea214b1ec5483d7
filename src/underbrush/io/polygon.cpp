#include "underbrush/io/polygon.hpp"

#include <algorithm>
#include <numeric>

namespace underbrush::io {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr size_t kMostCorners = 1024;

/// The corners seen along the polygon's normal, so that it turns counter-clockwise.
std::vector<Vec2> seen_flat(std::span<const Vec3> corners) {
  Vec3 normal = Vec3::Zero();
  for (size_t k = 0; k < corners.size(); ++k) {
    normal += (corners[k] - corners[0]).cross(corners[(k + 1) % corners.size()] - corners[0]);
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Vec2> flat;
  for (const Vec3& c : corners) {
    const Vec3 at = c - corners[0];
    flat.push_back(normal[axis] < 0 ? Vec2(at[v], at[u]) : Vec2(at[u], at[v]));
  }
  return flat;
}

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// The corners that are not clipped yet, in order.
class Rest {
 public:
  explicit Rest(const std::vector<Vec2>& flat) : flat_(flat), index_(flat.size()) {
    std::iota(index_.begin(), index_.end(), 0u);
  }
  size_t size() const { return index_.size(); }
  uint32_t at(size_t k) const { return index_[k % index_.size()]; }

  bool turns_right(size_t k) const {
    return turn(flat_[at(k + size() - 1)], flat_[at(k)], flat_[at(k + 1)]) < 0;
  }
  /// Whether corner `k` makes a triangle with its neighbours in which no other corner lies.
  bool is_ear(size_t k) const {
    const Vec2 &a = flat_[at(k + size() - 1)], &b = flat_[at(k)], &c = flat_[at(k + 1)];
    if (!(turn(a, b, c) > 0)) return false;
    for (size_t j = k + 2; j < k + size() - 1; ++j) {
      const Vec2& p = flat_[at(j)];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }
  std::array<uint32_t, 3> clip(size_t k) {
    const std::array<uint32_t, 3> ear{at(k + size() - 1), at(k), at(k + 1)};
    index_.erase(index_.begin() + std::ptrdiff_t(k));
    return ear;
  }

 private:
  const std::vector<Vec2>& flat_;
  std::vector<uint32_t> index_;
};

}  // namespace

std::vector<std::array<uint32_t, 3>> triangles_of_polygon(std::span<const Vec3> corners) {
  std::vector<std::array<uint32_t, 3>> out;
  if (corners.size() < 3) return out;
  const std::vector<Vec2> flat = seen_flat(corners);
  Rest rest(flat);
  bool convex = corners.size() == 3 || corners.size() > kMostCorners;
  for (size_t k = 0; !convex; ++k) {
    if (k == rest.size())
      convex = true;
    else if (rest.turns_right(k))
      break;
  }
  for (size_t from = 0; !convex && rest.size() > 3;) {
    size_t tried = 0;
    while (tried < rest.size() && !rest.is_ear((from + tried) % rest.size())) ++tried;
    if (tried == rest.size()) break;
    from = (from + tried) % rest.size();
    out.push_back(rest.clip(from));
    from %= rest.size();
  }
  for (size_t k = 2; k < rest.size(); ++k) out.push_back({rest.at(0), rest.at(k - 1), rest.at(k)});
  return out;
}

}  // namespace underbrush::io
