#include "underbrush/simulate/dynamic_world.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/elements/element_light.hpp"

namespace underbrush::simulate {
namespace {

using trace::Intersection;

/// A ball around all that a ray can meet of a model, in the frame of its instance.
struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

Ball ball_around(const elements::Model& model, double scale) {
  const Eigen::AlignedBox3d box = model.box();
  if (box.isEmpty()) return {};
  return {scale * box.center(), scale * (0.5 * box.diagonal().norm() + 1e-6)};
}

/// A cone around the rays of a batch that follow each other.
struct Bundle {
  size_t begin = 0, end = 0;
  Vec3 origin = Vec3::Zero(), axis = Vec3::Zero();
  double spread_m = 0;          ///< How far the origins of rays lie from `origin`.
  double cosine = 1, sine = 0;  ///< The cosine and sine of half its angle.

  Bundle(std::span<const Ray> rays, size_t first, size_t last)
      : begin(first), end(last), origin(rays[first].origin) {
    constexpr double kSlack = 1e-12;
    for (size_t i = begin; i < end; ++i) axis += rays[i].direction;
    axis.normalize();
    for (size_t i = begin; i < end; ++i) {
      spread_m = std::max(spread_m, (rays[i].origin - origin).squaredNorm());
      cosine = std::min(cosine, rays[i].direction.dot(axis));
    }
    spread_m = std::sqrt(spread_m);
    cosine -= kSlack;
    sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  }
  /// False only if no ray meets the ball. A cone lies on one side of each plane that touches it
  /// along its length.
  bool may_meet(const Ball& ball) const {
    const Vec3 to = ball.centre - origin;
    const double along = to.dot(axis),
                 across = std::sqrt(std::max(0.0, to.squaredNorm() - along * along));
    return !(cosine > 0) || across * cosine - along * sine <= ball.radius + spread_m;
  }
};

std::vector<Bundle> bundles_of(std::span<const Ray> rays) {
  constexpr size_t kRays = 32;
  std::vector<Bundle> out;
  out.reserve(rays.size() / kRays + 1);
  for (size_t i = 0; i < rays.size(); i += kRays) {
    out.emplace_back(rays, i, std::min(i + kRays, rays.size()));
  }
  return out;
}

Pose pose_at(const Trajectory& path, double time_s) {
  const auto& poses = path.poses();
  if (time_s <= poses.front().time_s) return poses.front().world_from_sensor;
  if (time_s >= poses.back().time_s) return poses.back().world_from_sensor;
  return *path.at(time_s);
}

/// A ball around the places that a ball of an object has from one time (s) to another.
Ball swept(const Ball& ball, const Trajectory& path, double from_s, double to_s) {
  Pose last = pose_at(path, from_s);
  Ball out{last * ball.centre, ball.radius};
  const auto go_on = [&](const Pose& next) {
    out.radius += (next.translation - last.translation).norm() +
                  ball.centre.norm() * last.rotation.angularDistance(next.rotation);
    last = next;
  };
  const auto& poses = path.poses();
  auto p = std::ranges::upper_bound(poses, from_s, {}, &StampedPose::time_s);
  for (; p != poses.end() && p->time_s < to_s; ++p) go_on(p->world_from_sensor);
  go_on(pose_at(path, to_s));
  return out;
}

}  // namespace

/// A moving object, alone in a world of its own frame.
struct DynamicWorld::Object {
  Object(elements::Mover m, const elements::Model& model, elements::Instance placed,
         trace::Draws draws)
      : mover(std::move(m)), ball(ball_around(model, double(placed.scale))) {
    placed.world_from_model = {};
    placed.model = 0;
    scene.models.push_back(model);
    scene.instances.push_back(placed);
    world = std::make_unique<trace::World>(scene, trace::Isa::kBest, draws);
  }
  elements::Mover mover;
  elements::Scene scene;
  std::unique_ptr<trace::World> world;
  Ball ball;
};

DynamicWorld::DynamicWorld(const trace::World& world) : world_(&world) {
  if (!world.unknown_space() || !model(0).light.known()) return;
  for (const bool is_low : {false, true}) {
    const auto kind = is_low ? elements::Kind::kGround : elements::Kind::kEllipsoid;
    unknown_reflectance_[size_t(is_low)] = elements::mean_reflectance(model(0), kind);
  }
}
DynamicWorld::DynamicWorld(DynamicWorld&&) noexcept = default;
DynamicWorld::~DynamicWorld() = default;

DynamicWorld::DynamicWorld(const elements::Scene& scene, std::vector<elements::Mover> movers,
                           trace::Draws draws) {
  still_ = std::make_unique<elements::Scene>(scene);
  const auto nothing = uint32_t(still_->models.size());
  still_->models.emplace_back();
  for (elements::Mover& m : movers) {
    require(m.instance < scene.instances.size(), "movers: there is no such instance");
    require(!m.world_from_object.empty(), "movers: a trajectory without poses");
    require_data(!object(m.instance), "movers: an instance moves twice");
    const elements::Instance& placed = scene.instances[m.instance];
    still_->instances[m.instance].model = nothing;
    const elements::Model& model = scene.models[placed.model];
    movers_.push_back(std::make_unique<Object>(std::move(m), model, placed, draws));
  }
  own_ = std::make_unique<trace::World>(*still_, trace::Isa::kBest, draws);
  world_ = own_.get();
}

void DynamicWorld::move(const elements::Mover& mover) {
  require(moves(mover.instance) && !mover.world_from_object.empty(),
          "movers: the instance does not move, or its trajectory has no poses");
  for (auto& o : movers_) {
    if (o->mover.instance == mover.instance) o->mover = mover;
  }
}

const DynamicWorld::Object* DynamicWorld::object(uint32_t instance) const {
  for (const auto& o : movers_) {
    if (o->mover.instance == instance) return o.get();
  }
  return nullptr;
}

const elements::Model& DynamicWorld::model(uint32_t instance) const {
  const Object* o = object(instance);
  return o ? o->scene.models[0] : world_->model(instance);
}

bool DynamicWorld::stands_as_one_model() const {
  if (world_->is_one_model()) return true;
  if (!still_ || moves(0) || still_->instances.size() != movers_.size() + 1) return false;
  const elements::Instance& only = still_->instances[0];
  const Pose& pose = only.world_from_model;
  return only.scale == 1 && pose.translation == model(0).origin &&
         pose.rotation.coeffs() == Eigen::Quaterniond::Identity().coeffs();
}

elements::Instance DynamicWorld::placed(uint32_t instance, double time_s) const {
  elements::Instance placed = world_->instance(instance);
  if (const Object* o = object(instance)) {
    placed.world_from_model = pose_at(o->mover.world_from_object, time_s);
  }
  return placed;
}

void MatterAt::find(uint32_t instance, double time_s) {
  const DynamicWorld::Object* o = world_.object(instance);
  const trace::World& still = world_.world();
  instance_ = instance;
  time_s_ = time_s;
  moves_ = o != nullptr;
  if (o) object_from_world_ = pose_at(o->mover.world_from_object, time_s).inverse();
  model_ = &world_.model(instance);
  salt_ = trace::instance_key(0, still.number(instance));
  grain_ = {*model_, o ? o->scene.instances[0] : still.instance(instance)};
  first_swaying_ = still.draws() == trace::Draws::kSwaying ? uint32_t(model_->first_ellipsoid())
                                                           : Intersection::kNone;
}

void DynamicWorld::nearest_accepted(std::span<const Ray> rays, std::span<const uint64_t> keys,
                                    std::span<const double> time_s,
                                    const trace::RangeLimits& limits,
                                    std::span<Intersection> met) const {
  require(time_s.empty() ? rays.empty() : rays.size() % time_s.size() == 0,
          "dynamic world: a whole number of rays a beam is needed");
  world_->nearest_accepted(rays, keys, limits, met);
  meet_movers(rays, keys, time_s, limits, met);
}

void DynamicWorld::meet_movers(std::span<const Ray> rays, std::span<const uint64_t> keys,
                               std::span<const double> time_s, const trace::RangeLimits& limits,
                               std::span<Intersection> met) const {
  if (movers_.empty() || rays.empty()) return;
  const size_t width = rays.size() / time_s.size();
  const bool sways = world_->draws() == trace::Draws::kSwaying;
  const auto [first_s, last_s] = std::ranges::minmax(time_s);
  const std::vector<Bundle> bundles = bundles_of(rays);
  std::vector<Ray> near;
  std::vector<uint64_t> near_keys;
  std::vector<size_t> number;
  std::vector<Intersection> found;
  for (const auto& o : movers_) {
    near.clear();
    near_keys.clear();
    number.clear();
    if (std::ranges::none_of(time_s, [&](double t) { return o->mover.is_there(t); })) continue;
    const Trajectory& path = o->mover.world_from_object;
    const Ball everywhere = swept(o->ball, path, first_s, last_s);
    double posed_at = NAN;
    Pose object_from_world;
    Vec3 centre = Vec3::Zero();
    for (const Bundle& bundle : bundles) {
      if (!bundle.may_meet(everywhere)) continue;
      for (size_t i = bundle.begin; i < bundle.end; ++i) {
        const double t = time_s[i / width];
        if (!o->mover.is_there(t)) continue;
        if (t != posed_at) {
          const Pose pose = pose_at(path, t);
          posed_at = t;
          object_from_world = pose.inverse();
          centre = pose * o->ball.centre;
        }
        const Vec3 to = centre - rays[i].origin;
        const double along = to.dot(rays[i].direction), r = o->ball.radius;
        if (along < -r || to.squaredNorm() - along * along > r * r) continue;
        if (!met[i].none() && met[i].t_m < along - r) continue;  // It is hidden.
        near.push_back(
            {object_from_world * rays[i].origin, object_from_world.rotation * rays[i].direction});
        near_keys.push_back(trace::object_key(keys[i], world_->number(o->mover.instance), sways));
        number.push_back(i);
      }
    }
    found.resize(near.size());
    o->world->nearest_accepted(near, near_keys, limits, found);
    for (size_t k = 0; k < near.size(); ++k) {
      if (found[k].none()) continue;
      found[k].instance = o->mover.instance;
      Intersection& best = met[number[k]];
      if (best.none() || found[k].before(best)) best = found[k];
    }
  }
}

}  // namespace underbrush::simulate
