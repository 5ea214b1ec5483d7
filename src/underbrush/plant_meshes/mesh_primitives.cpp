#include "underbrush/plant_meshes/mesh_primitives.hpp"

#include <algorithm>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::plant_meshes {
namespace {

using elements::Class;
using primitives::Primitive;

/// A class and the heights (m) at which it begins and ends.
struct ClassRange {
  Class label;
  double low, high;
};

std::vector<ClassRange> ranges_of(const MeshPrimitiveOptions& o, elements::ClassKind kind) {
  const primitives::SizeRules& s = o.sizes;
  if (kind == elements::ClassKind::kTree) {
    return {{Class::kSmallTree, s.tree_m, s.medium_tree_m},
            {Class::kMediumTree, s.medium_tree_m, s.large_tree_m},
            {Class::kLargeTree, s.large_tree_m, o.tallest_tree_m}};
  }
  const bool patch = kind == elements::ClassKind::kPatch;
  const auto label = [&](double height) { return shrub_class(s, height, patch); };
  return {{label(0), o.lowest_shrub_m, s.small_shrub_m},
          {label(s.small_shrub_m), s.small_shrub_m, s.medium_shrub_m},
          {label(s.medium_shrub_m), s.medium_shrub_m, s.large_shrub_m},
          {label(s.large_shrub_m), s.large_shrub_m, s.tree_m}};
}

/// A plant at the identity pose: foot under its centroid, x along its longer axis.
struct Upright {
  const PlantSource* source;
  std::vector<Vec3f> vertices;
  double height_m = 0, radius_m = 0;
  Vec3 foot = Vec3::Zero();
  double turn_rad = 0;
};

Upright upright(const PlantSource& plant) {
  require(!plant.triangles.empty(), "mesh primitives: a plant has no triangles");
  Vec3 mean = Vec3::Zero();
  double low = INFINITY, high = -INFINITY;
  for (const Vec3f& v : plant.vertices) {
    mean += v.cast<double>() / double(plant.vertices.size());
    low = std::min(low, double(v.z()));
    high = std::max(high, double(v.z()));
  }
  require(high - low > 1e-6, "mesh primitives: a plant has no height");
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec3f& v : plant.vertices) {
    const Eigen::Vector2d d = v.head<2>().cast<double>() - mean.head<2>();
    spread += d * d.transpose();
  }
  const Eigen::Vector2d axis = spectrum(spread).vectors.col(1);
  Upright out{&plant, {}, high - low};
  out.foot = Vec3(mean.x(), mean.y(), low);
  out.turn_rad = -std::atan2(axis.y(), axis.x());
  for (const Vec3f& v : plant.vertices) {
    const Eigen::Vector2d d = v.head<2>().cast<double>() - mean.head<2>();
    out.vertices.emplace_back(float(axis.dot(d)), float(axis.x() * d.y() - axis.y() * d.x()),
                              float(double(v.z()) - low));
    out.radius_m = std::max(out.radius_m, d.norm());
  }
  return out;
}

/// Appends the plant, scaled, turned about z and moved.
void add_plant(const Upright& plant, double scale, double yaw_rad, const Vec3& at, Primitive& to) {
  elements::TriangleMesh& mesh = to.model.surface;
  to.plants.push_back({plant.source->name, plant.foot, plant.turn_rad, scale, yaw_rad, at});
  const auto first = uint32_t(mesh.vertices.size());
  const double c = scale * std::cos(yaw_rad), s = scale * std::sin(yaw_rad);
  for (const Vec3f& v : plant.vertices) {
    const double x = double(v.x()), y = double(v.y());
    mesh.vertices.emplace_back(float(c * x - s * y + at.x()), float(s * x + c * y + at.y()),
                               float(scale * double(v.z()) + at.z()));
  }
  for (const auto& t : plant.source->triangles) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    mesh.hit.emplace_back();
  }
}

Primitive empty_primitive(Class label, const MeshPrimitiveOptions& o) {
  Primitive p;
  p.label = p.source.label = label;
  p.model.fitter = "mesh_primitives";
  p.model.surface.range_sigma_m = o.range_sigma_m;
  return p;
}

Primitive one_plant(Class label, const Upright& plant, double scale,
                    const MeshPrimitiveOptions& o) {
  Primitive p = empty_primitive(label, o);
  add_plant(plant, scale, 0, Vec3::Zero(), p);
  p.box.min.setConstant(INFINITY);
  p.box.max.setConstant(-INFINITY);
  for (const Vec3f& v : p.model.surface.vertices) {
    p.box.min = p.box.min.cwiseMin(v.cast<double>());
    p.box.max = p.box.max.cwiseMax(v.cast<double>());
  }
  p.source.box = p.box;
  return p;
}

/// Returns the factor by which the plant must be enlarged or reduced, at least 1.
double strain(const Upright& plant, double height_m) {
  return std::max(height_m / plant.height_m, plant.height_m / height_m);
}

/// Returns the plants that can be scaled to that height.
std::vector<const Upright*> plants_for(const std::vector<Upright>& plants, double height_m,
                                       const MeshPrimitiveOptions& o) {
  std::vector<const Upright*> out;
  for (const Upright& p : plants) {
    if (strain(p, height_m) <= o.most_scaling) out.push_back(&p);
  }
  if (out.empty() && !plants.empty()) {
    out.push_back(
        &*std::min_element(plants.begin(), plants.end(), [&](const Upright& a, const Upright& b) {
          return strain(a, height_m) < strain(b, height_m);
        }));
  }
  return out;
}

Primitive patch_cell(Class label, const std::vector<const Upright*>& plants, double height_m,
                     const MeshPrimitiveOptions& o, Stream& random) {
  Primitive p = empty_primitive(label, o);
  const double half = 0.5 * o.cell_m;
  double covered = 0;
  while (covered < o.cell_m * o.cell_m && p.model.surface.size() < o.most_triangles) {
    const Upright& plant =
        *plants[std::min(plants.size() - 1, size_t(random.uniform() * double(plants.size())))];
    // The first plant is as high as the cell, others down to two thirds of it.
    const double share = p.model.surface.size() ? random.uniform(2.0 / 3, 1) : 1;
    const double scale = share * height_m / plant.height_m;
    const double x = random.uniform(-half, half), y = random.uniform(-half, half);
    add_plant(plant, scale, random.uniform(0, 2 * M_PI), Vec3(x, y, 0), p);
    covered += M_PI * std::pow(scale * plant.radius_m, 2);
  }
  p.box = {Vec3(-half, -half, 0), Vec3(half, half, height_m)};
  p.source.box = p.box;
  return p;
}

}  // namespace

std::vector<Primitive> mesh_primitives(const std::vector<PlantSource>& plants,
                                       const MeshPrimitiveOptions& o) {
  require(o.sizes_per_class > 0 && o.cells_per_size >= 0 && o.most_scaling >= 1 && o.cell_m > 0 &&
              o.range_sigma_m >= 0,
          "mesh primitives: sizes, scaling and cells must be positive");
  std::vector<Upright> trees, shrubs;
  std::vector<Primitive> out;
  for (const PlantSource& source : plants) {
    Upright plant = upright(source);
    if (source.label) {
      out.push_back(one_plant(*source.label, plant, 1, o));
    } else {
      (plant.height_m >= o.sizes.tree_m ? trees : shrubs).push_back(std::move(plant));
    }
  }
  using enum elements::ClassKind;
  Stream random(o.seed);
  for (const auto kind : {kShrub, kPatch, kTree}) {
    const std::vector<Upright>& kin = kind == kTree ? trees : shrubs;
    if (kin.empty()) continue;
    for (const ClassRange& range : ranges_of(o, kind)) {
      for (int k = 0; k < o.sizes_per_class; ++k) {
        const double height = range.low + (k + 0.5) / o.sizes_per_class * (range.high - range.low);
        const auto fitting = plants_for(kin, height, o);
        if (kind == kPatch) {
          for (int cell = 0; cell < o.cells_per_size; ++cell) {
            out.push_back(patch_cell(range.label, fitting, height, o, random));
          }
          continue;
        }
        for (const Upright* plant : fitting) {
          out.push_back(one_plant(range.label, *plant, height / plant->height_m, o));
        }
      }
    }
  }
  return out;
}

}  // namespace underbrush::plant_meshes
