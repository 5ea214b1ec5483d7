#include "underbrush/primitives/extract.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "underbrush/core/cells.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::primitives {
namespace {

using elements::Model;

/// Finds the instance that owns each voxel, by majority vote (Boyer and Moore) in the log's order.
class OwnerMap {
 public:
  void add(const Vec3& p, uint32_t instance) {
    Vote& v = votes_[cell_of(p, kSideM)];
    if (v.count == 0) v.instance = instance;
    v.count += v.instance == instance ? 1 : -1;
  }
  /// Returns the owner of the voxel at p, or else of most voxels around; nothing where no points
  /// are near.
  std::optional<uint32_t> at(const Vec3& p) const {
    const Cell3 c = cell_of(p, kSideM);
    if (const auto found = votes_.find(c); found != votes_.end()) {
      return found->second.instance;
    }
    std::map<uint32_t, int> seen;
    for (int k = 0; k < 27; ++k) {
      const auto found = votes_.find(Cell3{c.x + k % 3 - 1, c.y + k / 3 % 3 - 1, c.z + k / 9 - 1});
      if (found != votes_.end()) ++seen[found->second.instance];
    }
    if (seen.empty()) return std::nullopt;
    return std::max_element(seen.begin(), seen.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }

 private:
  static constexpr double kSideM = 0.3;
  struct Vote {
    uint32_t instance = 0;
    int32_t count = 0;
  };
  CellMap<Cell3, Vote> votes_;
};

OwnerMap owners_of(BeamSource& labelled) {
  OwnerMap owners;
  for_each_object_hit(labelled, [&](const ObjectHit& hit) { owners.add(hit.point, hit.instance); });
  return owners;
}

/// Refined ellipsoids may lie a little beside the points that they were fitted to, m.
constexpr double kMarginM = 0.1;

/// The centres of a model's elements (without the ground) in the cells of a grid.
class Centres {
 public:
  explicit Centres(const Model& model) {
    for (const auto& t : model.surface.triangles) {
      Vec3 sum = Vec3::Zero();
      for (const uint32_t k : t) sum += model.surface.vertices[k].cast<double>();
      add(model.origin + sum / 3);
    }
    for (const auto& e : model.ellipsoids) add(model.origin + e.mean.cast<double>());
  }
  size_t size() const { return centre_.size(); }
  const Vec3& operator[](size_t k) const { return centre_[k]; }

  /// Returns the elements in the object's box or up to `margin_m` beside it, in order of number.
  std::vector<uint32_t> within(const PlacedObject& o, double margin_m) const {
    const Pose object_from_world = o.world_from_object().inverse();
    const double reach =
        std::max(o.box.min.head<2>().norm(), o.box.max.head<2>().norm()) + 2 * margin_m;
    std::vector<uint32_t> out;
    const auto [x0, y0] = cell_of(o.position.x() - reach, o.position.y() - reach, kCellM);
    const auto [x1, y1] = cell_of(o.position.x() + reach, o.position.y() + reach, kCellM);
    for (int32_t y = y0; y <= y1; ++y) {
      for (int32_t x = x0; x <= x1; ++x) {
        const auto found = cells_.find(Cell2{x, y});
        if (found == cells_.end()) continue;
        for (const uint32_t k : found->second) {
          const Vec3 p = object_from_world * centre_[k];
          const bool inside =
              (p.head<2>().array() >= o.box.min.head<2>().array() - margin_m).all() &&
              (p.array() <= o.box.max.array() + margin_m).all();
          if (inside) out.push_back(k);
        }
      }
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr double kCellM = 2;
  void add(const Vec3& p) {
    cells_[cell_of(p.x(), p.y(), kCellM)].push_back(uint32_t(centre_.size()));
    centre_.push_back(p);
  }
  std::vector<Vec3> centre_;
  CellMap<Cell2, std::vector<uint32_t>> cells_;
};

/// Whether nearly all beams passed through the element.
bool is_free_space(const Model& model, uint32_t k, double below) {
  if (k < model.surface.size()) return false;
  const elements::HitCount& h = model.ellipsoids[k - model.surface.size()].hit;
  return h.hits < below * (double(h.hits) + h.misses);
}

/// Returns the chosen elements (numbered surface first, then ellipsoids) in the object's frame.
Model cut(const Model& model, const PlacedObject& o, const std::vector<uint32_t>& chosen) {
  Model out = model.like();
  out.origin = Vec3::Zero();
  out.voxel_m = 0;  // Its cells lie on a grid of the world.
  const Pose object_from_world = o.world_from_object().inverse();
  const Mat3 turn = object_from_world.rotation.toRotationMatrix();
  const auto moved = [&](const Vec3f& p) {
    return Vec3f((object_from_world * (model.origin + p.cast<double>())).cast<float>());
  };
  std::unordered_map<uint32_t, uint32_t> vertex;
  for (const uint32_t k : chosen) {
    if (k < model.surface.size()) {
      std::array<uint32_t, 3> triangle{};
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t old = model.surface.triangles[k][c];
        const auto [at, is_new] = vertex.emplace(old, uint32_t(out.surface.vertices.size()));
        if (is_new) out.surface.vertices.push_back(moved(model.surface.vertices[old]));
        triangle[c] = at->second;
      }
      out.surface.triangles.push_back(triangle);
      out.surface.hit.push_back(model.surface.hit[k]);
      if (!model.surface.light.empty()) out.surface.light.push_back(model.surface.light[k]);
      if (!model.surface.roughness.empty()) {
        out.surface.roughness.push_back(model.surface.roughness[k]);
      }
      continue;
    }
    elements::Ellipsoid e = model.ellipsoids[k - model.surface.size()];
    e.mean = moved(e.mean);
    e.set_covariance(turn * e.covariance_matrix() * turn.transpose());
    e.label = uint32_t(o.label);
    out.ellipsoids.push_back(e);
  }
  return out;
}

}  // namespace

ExtractResult extract(const Model& model, BeamSource& labelled, const ExtractOptions& options,
                      const MeasureProgress& progress) {
  require(options.free_space_below >= 0 && options.free_space_below <= 1,
          "extract: the share of free space must lie in [0, 1]");
  ExtractResult out;
  const GroundSurface ground(model);
  out.measured = measure_objects(labelled, ground, options.measure, progress);
  const bool own = options.membership == Membership::kOwn;
  const OwnerMap owners = own ? owners_of(labelled) : OwnerMap{};
  const Centres centres(model);
  std::vector<uint8_t> taken(centres.size(), 0);
  out.elements =
      model.whole_count(elements::Kind::kSurface) + model.whole_count(elements::Kind::kEllipsoid);
  for (const PlacedObject& o : out.measured.objects) {
    std::vector<uint32_t> chosen = centres.within(o, own ? kMarginM : 0);
    if (own) {
      std::erase_if(chosen, [&](uint32_t k) {
        const std::optional<uint32_t> owner = owners.at(centres[k]);
        return owner && *owner != o.instance;
      });
    }
    out.free_space += std::erase_if(
        chosen, [&](uint32_t k) { return is_free_space(model, k, options.free_space_below); });
    if (chosen.empty()) {
      ++out.empty;
      continue;
    }
    if (chosen.size() < options.min_elements) {
      ++out.few_elements;
      continue;
    }
    for (const uint32_t k : chosen) taken[k] = 1;
    out.primitives.push_back({o.label, o.box, cut(model, o, chosen), o});
  }
  out.taken = size_t(std::count(taken.begin(), taken.end(), 1));
  return out;
}

}  // namespace underbrush::primitives
