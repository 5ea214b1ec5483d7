#include "underbrush/actors/registration.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "underbrush/core/kd_tree.inl"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/median.hpp"
#include "underbrush/core/parallel.hpp"

namespace underbrush::actors {
namespace {

using Vec4 = Eigen::Vector4d;

constexpr size_t kMostPoints = 400, kNearest = 32, kPlane = 8, kLeastOfPlane = 5;

/// The returns of a view in the frame of the given pose, and the change of that pose: x, y, z (m)
/// and heading (rad).
struct Placed {
  std::vector<Vec3> points;
  Vec4 change = Vec4::Zero();

  Vec3 in_actor(const Vec3& p) const {
    const double c = std::cos(change[3]), s = std::sin(change[3]);
    const Vec3 d = p - change.head<3>();
    return {c * d.x() + s * d.y(), c * d.y() - s * d.x(), d.z()};
  }
};

Placed placed(const View& view) {
  Placed out;
  const Pose actor_from_world = view.world_from_actor.inverse();
  const size_t step = 1 + view.returns / kMostPoints;
  size_t k = 0;
  for (size_t i = 0; i < view.beams.size(); ++i) {
    if (!view.beams.is_hit(i) || k++ % step != 0) continue;
    out.points.push_back(actor_from_world * view.beams.end_point(i));
  }
  return out;
}

/// The points of all views in the actor's frame.
class Cloud {
 public:
  explicit Cloud(const std::vector<Placed>& views) {
    for (uint32_t v = 0; v < views.size(); ++v) {
      for (const Vec3& p : views[v].points) {
        points_.push_back(views[v].in_actor(p).cast<float>());
        view_.push_back(v);
      }
    }
    tree_.emplace(points_);
  }

  struct Plane {
    Vec3 normal, point;
  };
  /// The plane through the nearest points of other views; nothing where these make none.
  std::optional<Plane> plane_near(const Vec3& at, uint32_t view, double reach_m) const {
    std::array<uint32_t, kNearest> index;
    std::array<float, kNearest> squared;
    const Vec3f query = at.cast<float>();
    const size_t found = tree_->nearest(query.data(), kNearest, index.data(), squared.data());
    std::array<Vec3, kPlane> near;
    size_t count = 0;
    for (size_t k = 0; k < found && count < kPlane; ++k) {
      if (double(squared[k]) > reach_m * reach_m) break;
      if (view_[index[k]] != view) near[count++] = points_[index[k]].cast<double>();
    }
    if (count < kLeastOfPlane) return {};
    Vec3 mean = Vec3::Zero();
    for (size_t k = 0; k < count; ++k) mean += near[k] / double(count);
    Mat3 spread = Mat3::Zero();
    for (size_t k = 0; k < count; ++k) spread += (near[k] - mean) * (near[k] - mean).transpose();
    const auto [extent, axes] = spectrum(spread);
    const bool is_line = extent[1]<0.02 * extent[2], is_ball = extent[0]> 0.3 * extent[1];
    if (is_line || is_ball) return {};
    return Plane{axes.col(0), mean};
  }

 private:
  std::vector<Vec3f> points_;
  std::vector<uint32_t> view_;
  std::optional<CloudTree> tree_;
};

/// The Gauss–Newton step of a view.
Vec4 step_of(const Placed& placed, uint32_t view, const Cloud& cloud,
             const RegistrationOptions& options, double reach_m) {
  const double scale = std::max(reach_m / 3, options.noise_m);
  Vec4 weight;
  weight << Vec3::Constant(1 / (options.prior_m * options.prior_m)),
      1 / (options.prior_rad * options.prior_rad);
  Eigen::Matrix4d normal = weight.asDiagonal();
  Vec4 right = -weight.cwiseProduct(placed.change);
  const double c = std::cos(placed.change[3]), s = std::sin(placed.change[3]);
  for (const Vec3& p : placed.points) {
    const Vec3 q = placed.in_actor(p);
    const auto plane = cloud.plane_near(q, view, reach_m);
    if (!plane) continue;
    const Vec3& n = plane->normal;
    const double r = n.dot(q - plane->point);
    Vec4 row;  // of the residual's derivatives
    row << -(c * n.x() - s * n.y()), -(s * n.x() + c * n.y()), -n.z(),
        n.x() * q.y() - n.y() * q.x();
    const double robust = scale * scale / (scale * scale + r * r);
    const double w = robust * robust / (options.noise_m * options.noise_m);
    normal += w * row * row.transpose();
    right -= w * r * row;
  }
  return solve(normal, right);
}

double median_distance(const std::vector<Placed>& views, double reach_m) {
  const Cloud cloud(views);
  std::vector<double> all;
  for (uint32_t v = 0; v < views.size(); ++v) {
    for (const Vec3& p : views[v].points) {
      const Vec3 q = views[v].in_actor(p);
      const auto plane = cloud.plane_near(q, v, reach_m);
      if (plane) all.push_back(std::abs(plane->normal.dot(q - plane->point)));
    }
  }
  return median(std::move(all));
}

}  // namespace

RegistrationReport register_views(std::vector<View>& views, const RegistrationOptions& options) {
  std::vector<Placed> all;
  all.reserve(views.size());
  for (const View& v : views) all.push_back(placed(v));
  RegistrationReport report;
  if (views.size() < 2) return report;
  report.before_m = median_distance(all, options.reach_m);
  for (int round = 0; round < options.rounds; ++round) {
    const double done = double(round) / std::max(1, options.rounds - 1);
    const double reach_m = options.reach_m * (1 - done / 2);
    const Cloud cloud(all);
    std::vector<Vec4> steps(all.size());
    parallel_for(all.size(), 1, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        steps[v] = step_of(all[v], uint32_t(v), cloud, options, reach_m);
      }
    });
    for (size_t v = 0; v < all.size(); ++v) all[v].change += steps[v] / 2;
  }
  report.after_m = median_distance(all, options.reach_m);
  for (size_t v = 0; v < views.size(); ++v) {
    const Vec4& by = all[v].change;
    views[v].world_from_actor =
        views[v].world_from_actor *
        Pose{Eigen::Quaterniond(Eigen::AngleAxisd(by[3], Vec3::UnitZ())), by.head<3>()};
  }
  return report;
}

}  // namespace underbrush::actors
