#include "underbrush/pipeline/out_of_reach.hpp"

#include <cstdio>
#include <vector>

#include "underbrush/core/median.hpp"
#include "underbrush/pipeline/pose_checks.hpp"

namespace underbrush::pipeline {
namespace {

using metrics::Bounds;

constexpr double kOtherCoordinatesM = 10e3, kPointM = 0.05;

std::string number(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// A distance with three or four digits, in m or km.
std::string length(double m) {
  return m < 1000 ? number("%.3g m", m) : number("%.4g km", m / 1000);
}

std::string place(const Bounds& b) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    text += std::string(axis ? ", " : "") + "xyz"[axis] + number(" %.1f", b.low[axis]);
    if (b.high[axis] - b.low[axis] > kPointM) text += number(" to %.1f", b.high[axis]);
  }
  return text + " m";
}

/// By how much the sensor's box lies beyond the world's along each axis; 0 where they overlap.
Vec3 gap_of(const Bounds& sensor, const Bounds& world) {
  return (sensor.low - world.high).cwiseMax(world.low - sensor.high).cwiseMax(0);
}

/// The distance (m) beside the world, seen from above.
double beside(const Bounds& sensor, const Bounds& world) {
  return gap_of(sensor, world).head<2>().norm();
}

std::string places(const Bounds& sensor, const Bounds& world) {
  return "the sensor lies at " + place(sensor) + ", the world at " + place(world) + "; ";
}

/// Where the sensor is, of which the world is out of reach.
std::string where_of(const Bounds& sensor, const Bounds& world) {
  const double up = gap_of(sensor, world).z(), aside = beside(sensor, world);
  std::string text;
  if (up > 0) text = length(up) + (sensor.low.z() > world.high.z() ? " above" : " below");
  if (aside > 0) text += (text.empty() ? "" : " and ") + length(aside) + " beside";
  return text;
}

/// Whether a world is high, and thin along its y axis only, as terrain whose y axis points up.
bool lies_on_its_side(const Bounds& world) {
  constexpr double kHigh = 30, kThin = 0.25;  // m
  const Vec3 size = world.high - world.low;
  return size.z() > kHigh && size.y() < kThin * std::min(size.x(), size.z());
}

/// The size of such a world, with the question which axis points up.
std::string asks_for_up(const Bounds& world) {
  const Vec3 size = world.high - world.low;
  return length(size.x()) + " by " + length(size.y()) + " wide and " + length(size.z()) +
         " high: does its y axis point up? Then --up y";
}

}  // namespace

std::string other_coordinates(const Bounds& sensor, const Bounds& world) {
  if (sensor.empty() || world.empty() || beside(sensor, world) <= kOtherCoordinatesM) return "";
  return places(sensor, world) + "they are " + length(beside(sensor, world)) +
         " apart, so one of them has coordinates of another system, such as UTM: shift the poses";
}

std::string ground_elsewhere(const Bounds& sensor, const elements::Scene& scene) {
  std::vector<elements::Instance> with_ground;
  for (const elements::Instance& placed : scene.instances) {
    if (!scene.models.at(placed.model).ground.triangles.empty()) with_ground.push_back(placed);
  }
  if (with_ground.empty()) return "";
  const Bounds ground = metrics::bounds_of(scene.models, with_ground);
  if (sensor.empty() || beside(sensor, ground) <= kOtherCoordinatesM) return "";
  return "no beam reaches the ground: the sensor lies at " + place(sensor) + ", the ground at " +
         place(ground) + "; one of them has coordinates of another system, such as UTM";
}

std::string why_nothing_is_hit(const Bounds& sensor, const Bounds& world, double max_range_m) {
  const std::string nothing = "no beam meets anything: ";
  if (sensor.empty() || world.empty()) return nothing + "the world is empty";
  const std::string other = other_coordinates(sensor, world);
  if (!other.empty()) return nothing + other;
  if (gap_of(sensor, world).norm() > max_range_m) {
    return nothing + places(sensor, world) + "it is " + where_of(sensor, world) +
           " the world, beyond its range of " + length(max_range_m);
  }
  if (lies_on_its_side(world)) return nothing + "the world is " + asks_for_up(world);
  return nothing + places(sensor, world) +
         "its beams point past the world: do the rotations of its poses turn from the sensor's "
         "frame to the world's?";
}

std::string larger_than_life(const Bounds& world) {
  constexpr double kHigh = 200, kSteep = 1.0 / 3;  // m
  if (world.empty()) return "";
  if (lies_on_its_side(world)) return "the world is " + asks_for_up(world);
  const Vec3 size = world.high - world.low;
  if (size.z() < kHigh || size.z() < kSteep * size.head<2>().maxCoeff()) return "";
  return "the world is " + length(size.head<2>().maxCoeff()) + " wide and " + length(size.z()) +
         " high: are its coordinates in mm? Then --unit 0.001";
}

std::vector<std::string> warnings_of_path(const Trajectory& path) {
  constexpr double kFast = 400;  // m/s
  std::vector<double> speed;
  std::vector<ScanInfo> places;
  for (const StampedPose& b : path.poses()) {
    if (!places.empty()) {
      const ScanInfo& a = places.back();
      speed.push_back((b.world_from_sensor.translation - a.world_from_sensor.translation).norm() /
                      (b.time_s - a.time_s));
    }
    places.push_back({0, b.time_s, b.world_from_sensor});
  }
  std::vector<std::string> out;
  const double usual = median(speed);
  if (usual >= kFast) {
    out.push_back("by its trajectory the sensor moves at " + number("%.0f", usual) +
                  " m/s: are positions in mm, or times not in s?");
  }
  if (places.empty()) return out;
  if (std::string tilt = warning_of_tilt(places); !tilt.empty()) out.push_back(std::move(tilt));
  return out;
}

}  // namespace underbrush::pipeline
