#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {
namespace {

Met meet_placed(const View& view, const Batch& batch, int ray, uint32_t instance,
                uint32_t element) {
  const elements::Instance& placed = view.instances[instance];
  return meet(*view.models[placed.model], placed, instance, element, *batch.ray[ray],
              batch.limits);
}

}  // namespace

Placement place(const View& view, uint32_t instance, const double centre[3]) {
  const elements::Instance& placed = view.instances[instance];
  Placement p;
  p.bvh = &view.bvhs[placed.model];
  p.translation = is_translation(placed);
  p.scale = placed.scale;
  p.salt = instance_key(0, instance);
  const Mat3 back = placed.world_from_model.rotation.conjugate().toRotationMatrix();
  const Vec3 world = Vec3(view.origin[0], view.origin[1], view.origin[2]) +
                     Vec3(centre[0], centre[1], centre[2]);
  const Vec3 local = back * (world - placed.world_from_model.translation) / p.scale;
  for (int r = 0; r < 3; ++r) {
    p.centre[r] = local[r];
    for (int c = 0; c < 3; ++c) p.rotation[3 * r + c] = back(r, c);
  }
  return p;
}

bool settle_nearest(const View& view, Ask ask, Batch& batch, int ray, uint32_t instance,
                    uint32_t element, uint32_t have_instance, uint32_t have_element) {
  const Met met = meet_placed(view, batch, ray, instance, element);
  if (met.none()) return false;
  if (ask == Ask::kAccepted && !accepts(batch.key[ray], met)) return false;
  Met& best = batch.best[ray];
  if (have_element != Met::kNone) {
    best = meet_placed(view, batch, ray, have_instance, have_element);
  }
  if (!best.none() && !met.before(best)) return false;
  best = met;
  return true;
}

void settle_known(const View& view, Batch& batch, int ray, uint32_t instance, uint32_t element) {
  batch.best[ray] = meet_placed(view, batch, ray, instance, element);
}

void add_candidate(Batch& batch, int ray, uint32_t instance, uint32_t element) {
  batch.candidates.push_back({uint32_t(ray), instance, element});
}

}  // namespace underbrush::trace
