/// \file
/// A small world, a drive through it, and the parts of its time.
#pragma once
#include <limits>

#include "drive_past.hpp"
#include "underbrush/live/live_sensors.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::live::test {

inline Pose turned(double yaw_rad, const Vec3& at) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ())), at};
}

/// Ground with bushes, and a cart that moves along `path` as instance 1.
inline pipeline::World site(const Trajectory& path = Trajectory({{0, turned(0, {5, 0.2, 0})}})) {
  pipeline::World world;
  elements::Model ground = underbrush::test::flat_ground(60), cart;
  for (int k = 0; k < 40; ++k) {
    const float a = float(k), r = 4 + 0.5F * float(k);
    underbrush::test::add_bush({r * std::cos(a), r * std::sin(a), 0.8F}, {0.3, 0.2, 0.4}, 0.6F,
                               ground);
  }
  cart.tau = 3;
  underbrush::test::add_bush({0, 0, 0.8F}, {0.5, 0.3, 0.3}, 1, cart);
  world.scene.models.push_back(std::move(ground));
  pipeline::add_mover(world, std::move(cart), path, "", "cart");
  return world;
}

/// Where the vehicle and the cart are at t.
inline Pose vehicle_at(double t) { return turned(0.5 * t, {3 * t, 0.2 * t * t, 1.8}); }
inline Pose cart_at(double t) { return turned(-t, {6 - 2 * t, 3 * t, 0}); }

/// The boundaries of parts of 0.25 s, of which none is a whole number of firings.
inline std::vector<double> boundaries() { return {7, 7.01, 7.0233, 7.05, 7.1, 7.17, 7.2, 7.25}; }

template <class PoseAt>
std::vector<StampedPose> poses(const std::vector<double>& times, PoseAt pose_at) {
  std::vector<StampedPose> out;
  out.reserve(times.size());
  for (const double t : times) out.push_back({t, pose_at(t - 7)});
  return out;
}

/// The last poses of `all` up to boundary k: one before the part, and those of its ends.
inline Motion motion_of_part(const std::vector<StampedPose>& all, size_t k) {
  return {{all.begin() + long(k < 2 ? 0 : k - 2), all.begin() + long(k) + 1}};
}

/// The part before boundary k, with the cart moved along.
inline Firing part(size_t k) {
  const std::vector<double> t = boundaries();
  Firing f{t[0], t[k - 1], t[k], motion_of_part(poses(t, vehicle_at), k), {}};
  f.actors.push_back({"cart", motion_of_part(poses(t, cart_at), k)});
  return f;
}

inline void append(BeamLog& all, const BeamLog& more) {
  all.empty() ? void(all = more) : all.append(more, 0, more.size());
}

}  // namespace underbrush::live::test
