#include "underbrush/test_site/skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace underbrush::test_site {
namespace {

struct Marker {
  Vec3 at;
  int32_t node = -1;  // Nearest node.
  double square = std::numeric_limits<double>::infinity();
};

// Assigns the markers to the nearest node, with [begin, end) as new candidates, and removes those
// reached.
void update(std::vector<Marker>& markers, const Skeleton& skeleton, size_t begin,
            double reached_m) {
  for (Marker& m : markers) {
    for (size_t i = begin; i < skeleton.size(); ++i) {
      const double square = (skeleton.position[i] - m.at).squaredNorm();
      if (square < m.square) m.square = square, m.node = int32_t(i);
    }
  }
  std::erase_if(markers, [&](const Marker& m) { return m.square < reached_m * reached_m; });
}

}  // namespace

int32_t add_limb(Skeleton& skeleton, int32_t from, const Vec3& direction, double length_m,
                 double step_m, double rise) {
  const int steps = std::max(1, int(std::lround(length_m / step_m)));
  const Vec3 start = skeleton.position[size_t(from)];
  for (int i = 1; i <= steps; ++i) {
    const double s = length_m * i / steps;
    from = skeleton.add(start + s * direction + rise * s * s * Vec3::UnitZ(), from);
  }
  return from;
}

void grow_into(Skeleton& skeleton, std::vector<Vec3> points, const GrowthOptions& options) {
  std::vector<Marker> markers;
  markers.reserve(points.size());
  for (const Vec3& p : points) markers.push_back({p});
  std::vector<Vec3> pull, last_step(skeleton.size(), Vec3::Zero());
  size_t fresh = 0;
  while (true) {
    update(markers, skeleton, fresh, options.reached_m);
    fresh = skeleton.size();
    pull.assign(fresh, Vec3::Zero());
    for (const Marker& m : markers) {
      pull[size_t(m.node)] += (m.at - skeleton.position[size_t(m.node)]).normalized();
    }
    last_step.resize(fresh, Vec3::Zero());
    for (size_t i = 0; i < fresh; ++i) {
      if (pull[i].isZero()) continue;
      const Vec3 before = skeleton.segment(i);
      Vec3 to = pull[i].normalized();
      if (last_step[i].isZero() &&
          !before.isZero()) {  // A side branch turns freely, a tip does not.
        to += options.persistence * before.normalized();
      }
      if (to.norm() < 1e-3) continue;
      to.normalize();
      // A node attracted twice in the same direction is caught between two markers and stops
      // growing.
      if (last_step[i].dot(to) > 0.95) continue;
      last_step[i] = to;
      skeleton.add(skeleton.position[i] + options.step_m * to, int32_t(i));
    }
    if (skeleton.size() == fresh) return;
  }
}

void add_side_shoots(Skeleton& skeleton, const std::vector<bool>& twig, double length_m,
                     Stream& random) {
  double roll = random.uniform(0, 2 * M_PI);
  for (size_t i = 0; i < twig.size(); ++i) {
    if (!twig[i]) continue;
    const Vec3 along = skeleton.segment(i).normalized(), across = along.unitOrthogonal();
    roll += kGoldenAngle + random.uniform(-0.3, 0.3);
    const Vec3 away = std::cos(roll) * across + std::sin(roll) * along.cross(across);
    const double length = length_m * random.uniform(0.7, 1.3);
    skeleton.add(skeleton.position[i] + length * (0.6 * along + 0.8 * away), int32_t(i));
  }
}

std::vector<uint32_t> carried_tips(const Skeleton& skeleton) {
  std::vector<uint32_t> tips(skeleton.size(), 0);
  for (size_t i = skeleton.size(); i-- > 0;) {
    tips[i] = std::max(tips[i], 1u);
    if (skeleton.parent[i] >= 0) tips[size_t(skeleton.parent[i])] += tips[i];
  }
  return tips;
}

std::vector<bool> twigs(const Skeleton& skeleton, uint32_t most) {
  const std::vector<uint32_t> tips = carried_tips(skeleton);
  std::vector<bool> twig(skeleton.size());
  for (size_t i = 0; i < twig.size(); ++i) twig[i] = skeleton.parent[i] >= 0 && tips[i] <= most;
  return twig;
}

std::vector<double> pipe_radii(const std::vector<uint32_t>& tips, double base_m, double tip_m) {
  std::vector<double> radii(tips.size());
  const uint32_t most = *std::max_element(tips.begin(), tips.end());
  const double power = most > 1 ? std::log(base_m / tip_m) / std::log(double(most)) : 0;
  for (size_t i = 0; i < tips.size(); ++i) radii[i] = tip_m * std::pow(double(tips[i]), power);
  return radii;
}

}  // namespace underbrush::test_site
