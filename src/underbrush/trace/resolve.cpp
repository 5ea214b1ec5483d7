#include <algorithm>

#include "underbrush/trace/kernel.hpp"

namespace underbrush::trace {

namespace {

constexpr HashFactors hash_factors() {
  constexpr uint32_t kTrialFactor[3] = {0x7feb352du, 0x846ca68bu, 0x9e3779b1u};
  HashFactors out{};
  for (int k = 0; k < 3; ++k) {
    for (uint32_t& lane : out.trial[k]) lane = kTrialFactor[k];
    for (uint32_t& lane : out.cell[k]) lane = kCellFactor[k];
  }
  return out;
}

}  // namespace

const HashFactors kHashFactors = hash_factors();

Intersection intersect_placed(const View& view, const Batch& batch, const Candidate& c) {
  const elements::Instance& placed = view.instances[c.instance];
  return intersect(*view.models[placed.model], placed, c.instance, c.element, batch.rays[c.ray],
                   batch.limits);
}

void place_ray(const View& view, const Batch& batch, const Candidate& c, double origin[3],
               double direction[3]) {
  const Ray local = to_model(view.instances[c.instance], batch.rays[c.ray]);
  std::copy_n(local.origin.data(), 3, origin);
  std::copy_n(local.direction.data(), 3, direction);
}

InstanceTransform transform_of(const View& view, uint32_t instance) {
  const elements::Instance& placed = view.instances[instance];
  InstanceTransform s;
  s.model = &view.model_views[placed.model];
  s.triangles = view.bvhs[placed.model].triangles.data();
  std::copy_n(placed.world_from_model.translation.data(), 3, s.translation);
  s.translation[3] = 0;
  s.scale_tau2[0] = double(placed.scale);
  s.scale_tau2[1] = s.model->tau2;
  s.is_translation = is_translation(placed);
  return s;
}

Placement place(const View& view, uint32_t instance, const double centre[3]) {
  const elements::Instance& placed = view.instances[instance];
  Placement p;
  p.bvh = &view.bvhs[placed.model];
  p.translation = is_translation(placed);
  p.scale = placed.scale;
  p.tau2 = view.model_views[placed.model].tau2;
  p.cells_per_m = &view.model_views[placed.model].cells_per_m;
  p.sways = view.model_views[placed.model].sways;
  p.leaf_level = view.model_views[placed.model].leaf_level;
  p.leaf_slope = view.model_views[placed.model].leaf_slope;
  p.salt = instance_key(0, view.numbers ? view.numbers[instance] : instance);
  const Mat3 back = placed.world_from_model.rotation.conjugate().toRotationMatrix();
  const Vec3 world =
      Vec3(view.origin[0], view.origin[1], view.origin[2]) + Vec3(centre[0], centre[1], centre[2]);
  const Vec3 local = back * (world - placed.world_from_model.translation) / p.scale;
  for (int r = 0; r < 3; ++r) {
    p.centre[r] = local[r];
    for (int c = 0; c < 3; ++c) p.rotation[3 * r + c] = back(r, c);
  }
  return p;
}

/// Whether a ray ends at what it met.
static bool ends(const View& view, const Batch& batch, size_t ray, Intersection met) {
  const elements::Instance& placed = view.instances[met.instance];
  if (view.numbers) met.instance = view.numbers[met.instance];
  const ModelView& model = view.model_views[placed.model];
  const bool ellipsoid = met.element >= model.triangle_count;
  const uint64_t key = batch.keys[ray];
  if (model.cells_per_m.triangles == 0) return accepts(key, met);
  const uint32_t cell = Grain(*view.models[placed.model], placed).cell(batch.rays[ray], met);
  if (!model.sways) return accepts(key, met, cell);
  return accepts(uint32_t(key), met,
                 ellipsoid ? swaying_cell(cell, met.element, uint32_t(key >> 32)) : cell);
}

bool resolve_nearest(const View& view, Query query, Batch& batch, size_t ray, uint32_t instance,
                     uint32_t element, uint32_t have_instance, uint32_t have_element) {
  const Intersection met = intersect_placed(view, batch, {uint32_t(ray), instance, element});
  if (met.none()) return false;
  if (query == Query::kAccepted && !ends(view, batch, ray, met)) return false;
  Intersection& best = batch.best[ray];
  if (have_element != Intersection::kNone) {
    if (have_element & kInBlock) {
      const Bvh& bvh = view.bvhs[view.instances[have_instance].model];
      const uint32_t place = have_element & ~kInBlock;
      have_element =
          bvh.triangles[place / (2 * kWidth)].element[place % 2][place / 2 % kWidth] & kElementMask;
    }
    best = intersect_placed(view, batch, {uint32_t(ray), have_instance, have_element});
  }
  if (!best.none() && !met.before(best)) return false;
  best = met;
  return true;
}

void add_candidate(Batch& batch, const Candidate& candidate, const ApproachBound& bound) {
  batch.candidates.push_back(candidate);
  batch.bounds.push_back(bound);
}

}  // namespace underbrush::trace
