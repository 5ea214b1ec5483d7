#include "underbrush/live/live_sensors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "underbrush/core/check.hpp"
#include "underbrush/core/within.hpp"
#include "underbrush/pipeline/simulate_log.hpp"

namespace underbrush::live {
namespace {

perception::Rig rig_of_one(const sensor::Sensor& sensor) {
  perception::Rig rig;
  rig.sensors.push_back({sensor.name, sensor.name, {}, 0, 0});
  return rig;
}

/// Makes a rotation that is nearly one a unit quaternion; those that are stay what they are.
void check_pose(Pose& pose) {
  constexpr double kLoose = 1e-3, kExact = 1e-12;
  const double off = std::abs(pose.rotation.norm() - 1);
  require(off < kLoose, "motion: a rotation is not a unit quaternion");
  if (off > kExact) pose.rotation.normalize();
  require(is_within(pose.translation, kMaxCoordinate),
          "motion: a position is not finite or too far from the origin");
}

void check_times(const Firing& f) {
  require(std::isfinite(f.start_s) && std::isfinite(f.from_s) && std::isfinite(f.until_s),
          "fire: a time is not finite");
  require(f.start_s <= f.from_s && f.from_s <= f.until_s,
          "fire: times must be in order, start <= from <= until");
}

/// The path of the vehicle. It stands still before its first pose, because the first firing begins
/// up to a firing's length before `from_s`.
Trajectory vehicle_path(const Firing& f) {
  constexpr double kBefore = 1;  // s
  Motion motion = f.vehicle;
  require(!motion.poses.empty(), "fire: the vehicle has no pose");
  Trajectory path = trajectory_of(motion, f.until_s);
  std::vector<StampedPose> poses = path.poses();
  if (poses.size() == 1) return path;
  require(poses.front().time_s <= f.from_s && poses.back().time_s >= f.until_s,
          "fire: the vehicle needs poses from the beginning of the firing to its end");
  if (poses.front().time_s == f.from_s) {
    poses.insert(poses.begin(), {f.from_s - kBefore, poses.front().world_from_sensor});
  }
  return Trajectory(std::move(poses));
}

}  // namespace

Trajectory trajectory_of(const Motion& motion, double until_s) {
  require(!motion.poses.empty(), "motion: it has no pose");
  std::vector<StampedPose> poses = motion.poses;
  for (StampedPose& p : poses) check_pose(p.world_from_sensor);
  const bool moves =
      motion.velocity_m_per_s != Vec3::Zero() || motion.turn_rate_rad_per_s != Vec3::Zero();
  if (!moves) return Trajectory(std::move(poses));
  require(poses.size() == 1, "motion: velocities are of a single pose");
  const StampedPose& first = poses.front();
  const double duration_s = until_s - first.time_s;
  const Vec3 turn = duration_s * motion.turn_rate_rad_per_s;
  require(turn.norm() < M_PI, "motion: it turns by half a turn or more, or is not finite");
  if (!(duration_s > 0)) return Trajectory(std::move(poses));
  StampedPose last{until_s, first.world_from_sensor};
  last.world_from_sensor.translation += duration_s * motion.velocity_m_per_s;
  last.world_from_sensor.rotation =
      (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) *
       first.world_from_sensor.rotation)
          .normalized();
  check_pose(last.world_from_sensor);
  return Trajectory({first, last});
}

LiveSensors::LiveSensors(pipeline::TracedWorld& world, const pipeline::SimulateOptions& options,
                         sensor::Sensor sensor)
    : world_(world),
      is_rig_(false),
      rig_(rig_of_one(sensor)),
      sensors_{std::move(sensor)},
      simulation_(world, options, [this](const char*) { return sensors_[0]; }) {
  require(options.beams.empty(), "live: the beams of a firing are those of its time");
}

LiveSensors::LiveSensors(pipeline::TracedWorld& world, const pipeline::SimulateOptions& options,
                         perception::Rig rig)
    : world_(world),
      is_rig_(true),
      rig_(std::move(rig)),
      sensors_(perception::sensors_of(rig_)),
      simulation_(world, options, sensors_) {}

std::vector<std::string> LiveSensors::actors() const {
  std::vector<std::string> out;
  for (const pipeline::NamedMover& m : world_.movers()) {
    if (std::ranges::find(out, m.name) == out.end()) out.push_back(m.name);
  }
  return out;
}

double LiveSensors::beams_in(const Firing& firing) const {
  double beams = 0;
  for (const sensor::Sensor& s : sensors_) beams += s.beams_per_s();
  return beams * (firing.until_s - firing.from_s);
}

void LiveSensors::move_actors(const Firing& firing) {
  constexpr double kAlways = std::numeric_limits<double>::infinity();
  const auto named = [&](const std::string& name) {
    return std::ranges::count(world_.movers(), name, &pipeline::NamedMover::name);
  };
  for (const ActorMotion& a : firing.actors) {
    if (named(a.name) == 0)
      throw std::invalid_argument("fire: there is no actor " + in_quotes(a.name));
  }
  for (const pipeline::NamedMover& m : world_.movers()) {
    elements::Mover now = m.mover;
    for (const ActorMotion& a : firing.actors) {
      if (a.name != m.name) continue;
      if (a.is_absent) {
        now.from_s = kAlways;
      } else {
        now.world_from_object = trajectory_of(a.motion, firing.until_s);
        if (named(a.name) == 1) now.from_s = -kAlways, now.to_s = kAlways;
      }
    }
    world_.move(now);
  }
}

BeamLog LiveSensors::answered(size_t first_beam, uint32_t first_scan, BeamSource& beams) {
  const pipeline::SimulateOptions& options = simulation_.options();
  BeamLog out, chunk;
  beams.rewind();
  while (beams.next(chunk)) {
    const size_t fired = chunk.size();
    chunk.info.has_misses = true;
    if (options.max_range_m > 0) chunk.info.max_range_m = options.max_range_m;
    for (uint32_t& scan : chunk.scan) scan += first_scan;
    for (ScanInfo& s : chunk.info.scans) s.scan += first_scan;
    simulation_.answer(first_beam, chunk);
    first_beam += fired;
    out.empty() ? void(out = std::move(chunk)) : out.append(chunk, 0, chunk.size());
  }
  if (out.empty()) out.info = beams.info();
  if (options.element_ids) out.info.element_classes = world_.element_classes();
  return out;
}

BeamLog LiveSensors::fire_one(const Firing& f, const Trajectory& path) {
  sensor::PatternSource pattern(sensors_[0], path, f.start_s, f.until_s, pipeline::kSimulatedBeams,
                                f.from_s);
  const size_t first = pattern.beams_before(f.from_s);
  BeamWindow beams(pattern, first, std::numeric_limits<size_t>::max());
  simulation_.recognise(beams);
  return answered(f.first_beam + first, f.first_scan, beams);
}

BeamLog LiveSensors::fire_rig(const Firing& f, const Trajectory& path) {
  perception::RigSource beams(rig_, sensors_, path, {f.start_s, f.from_s, f.until_s},
                              pipeline::kSimulatedBeams);
  std::vector<size_t> fired = beams.fired_before();
  for (size_t& n : fired) n += f.first_beam;
  simulation_.continue_after(fired);
  return answered(std::ranges::max(fired), f.first_scan, beams);
}

BeamLog LiveSensors::fire(const Firing& firing) {
  check_times(firing);
  const Trajectory path = vehicle_path(firing);
  move_actors(firing);
  return is_rig_ ? fire_rig(firing, path) : fire_one(firing, path);
}

}  // namespace underbrush::live
