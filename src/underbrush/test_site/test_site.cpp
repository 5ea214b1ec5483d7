#include "underbrush/test_site/test_site.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/prototypes.hpp"

namespace underbrush::test_site {
namespace {

enum Purposes : uint32_t { kTerrain, kPlants, kTrees, kShrubs, kTallGrass, kMowedGrass, kMeadows };

uint64_t seed_for(uint64_t seed, Purposes purpose) {
  return random_bits(seed, purpose, Purpose::kPlace);
}

struct Spot {
  uint32_t prototype;
  double x, y, yaw, scale;
};

// Places plants where they may stand, and keeps those that stand already.
class Planter {
 public:
  explicit Planter(Site& site) : site_(site) {}

  // Throws darts for `count` plants of the range, clear of the track and of trunks. Crowns keep
  // `spacing` times the sum of their radii apart.
  template <class ClassOfHeight>
  void scatter(PrototypeRange range, int count, double spacing, const ClassOfHeight& label,
               uint64_t seed) {
    constexpr double kFromTrunk = 0.8;
    Stream random(seed);
    std::vector<Vec3> standing;  // x, y, radius.
    const auto clear = [&](const Spot& s, double radius_m) {
      const auto distance = [&](const Vec3& o) { return std::hypot(o.x() - s.x, o.y() - s.y); };
      return beside_track(s) > 0 &&
             std::all_of(
                 standing.begin(), standing.end(),
                 [&](const Vec3& o) { return distance(o) > spacing * (o.z() + radius_m); }) &&
             std::all_of(trunks_.begin(), trunks_.end(),
                         [&](const Vec3& o) { return distance(o) > kFromTrunk; });
    };
    for (int tries = 0; int(standing.size()) < count && tries < 200 * count; ++tries) {
      const TerrainParameters& t = site_.parameters.terrain;
      const double x = t.size_x_m * random.uniform(-0.5, 0.5);
      const double y = t.size_y_m * random.uniform(-0.5, 0.5);
      const Spot spot = draw(range, standing.size(), x, y, random);
      const double radius_m = spot.scale * site_.prototypes[spot.prototype].radius_m;
      if (!clear(spot, radius_m)) continue;
      standing.emplace_back(x, y, radius_m);
      plant(spot, 0.2, label(spot.scale * site_.prototypes[spot.prototype].height_m));
    }
    trunks_.insert(trunks_.end(), standing.begin(), standing.end());
  }

  // Sows grass on a jittered grid with the probability `density` (of x, y and the distance to the
  // track's edge).
  template <class Density>
  void sow(PrototypeRange range, double per_m2, const Density& density, uint64_t seed) {
    if (per_m2 <= 0) return;
    Stream random(seed);
    const TerrainParameters& t = site_.parameters.terrain;
    const double cell = 1 / std::sqrt(per_m2);
    const auto nx = int(t.size_x_m / cell), ny = int(t.size_y_m / cell);
    for (int i = 0; i < nx * ny; ++i) {
      const double x = cell * (i % nx + random.uniform()) - 0.5 * t.size_x_m;
      const double y = cell * (i / nx + random.uniform()) - 0.5 * t.size_y_m;
      const Spot spot = draw(range, random.below(64), x, y, random);
      const double keep = random.uniform(), beside_m = beside_track(spot);
      if (beside_m > 0 && keep < density(x, y, beside_m)) plant(spot, 0.1, elements::Class::kGrass);
    }
  }

 private:
  // Draws a placement; the `nth` plant takes the range's prototypes in turn.
  static Spot draw(PrototypeRange range, size_t nth, double x, double y, Stream& random) {
    Spot spot{range.begin + uint32_t(nth % (range.end - range.begin)), x, y, 0, 0};
    spot.yaw = random.uniform(0, 2 * M_PI);
    spot.scale = random.uniform(0.88, 1.12);
    return spot;
  }

  // Returns the gap (m) between a plant's crown and the edge of the track.
  double beside_track(const Spot& s) const {
    return site_.terrain.distance_to_track(s.x, s.y) - site_.parameters.terrain.track_half_width_m -
           s.scale * site_.prototypes[s.prototype].radius_m;
  }

  // Places a plant with its foot on the lowest ground within `foot_m`, so that no slope lifts it.
  void plant(const Spot& s, double foot_m, elements::Class label) {
    double z = site_.terrain.height(s.x, s.y);
    for (int k = 0; k < 4; ++k) {
      const double x = s.x + foot_m * std::cos(M_PI_2 * k), y = s.y + foot_m * std::sin(M_PI_2 * k);
      z = std::min(z, site_.terrain.height(x, y));
    }
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(s.yaw, Vec3::UnitZ())), Vec3(s.x, s.y, z)};
    const auto instance = uint32_t(site_.placements.size() + 1);
    site_.placements.push_back({s.prototype, pose, s.scale, label, instance});
  }

  Site& site_;
  std::vector<Vec3> trunks_;
};

// Patches of meadow 5 to 15 m across; the value is positive where grass stands high.
class Meadows {
 public:
  explicit Meadows(uint64_t seed) {
    Stream random(seed);
    for (auto& w : waves_) {
      const double azimuth = random.uniform(0, 2 * M_PI), k = 2 * M_PI / random.uniform(9, 25);
      w = Vec3(k * std::cos(azimuth), k * std::sin(azimuth), random.uniform(0, 2 * M_PI));
    }
  }
  double operator()(double x, double y) const {
    double sum = 0;
    for (const auto& w : waves_) sum += std::cos(w.x() * x + w.y() * y + w.z());
    return sum;
  }

 private:
  std::array<Vec3, 6> waves_;
};

// Writes the triangles of a placed plant to their places in the flat world.
void place(const Site& site, const Placement& p, size_t vertex, size_t triangle, FlatSite& flat) {
  const PlantMesh& plant = site.prototypes[p.prototype].plant;
  elements::TriangleMesh& surface = flat.model.surface;
  const Mat3 turn = p.scale * p.world_from_plant.rotation.toRotationMatrix();
  for (size_t i = 0; i < plant.mesh.vertices.size(); ++i) {
    const Vec3 at = turn * plant.mesh.vertices[i].cast<double>() + p.world_from_plant.translation;
    surface.vertices[vertex + i] = (at - flat.model.origin).cast<float>();
  }
  for (size_t i = 0; i < plant.mesh.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      surface.triangles[triangle + i][k] = plant.mesh.triangles[i][k] + uint32_t(vertex);
    }
    const size_t element = flat.model.ground.size() + triangle + i;
    flat.label[element] = p.label;
    flat.instance[element] = p.instance;
    flat.part[element] = plant.part[i];
  }
}

}  // namespace

Site make_site(const SiteParameters& p) {
  require(p.trees >= 0 && p.shrubs >= 0 && p.tussocks_per_m2 >= 0 && p.mowed_per_m2 >= 0,
          "site: numbers of plants must not be negative");
  Site site{p, Terrain(p.terrain, seed_for(p.seed, kTerrain)), {}, {}, {}};
  PrototypeSet set = make_prototypes(seed_for(p.seed, kPlants));
  site.prototypes = std::move(set.prototypes);
  Planter planter(site);
  planter.scatter(set.trees, p.trees, 0.75, elements::tree_class, seed_for(p.seed, kTrees));
  planter.scatter(set.shrubs, p.shrubs, 0.8, elements::shrub_class, seed_for(p.seed, kShrubs));
  const Meadows meadows(seed_for(p.seed, kMeadows));
  const auto tall = [&](double x, double y, double beside_m) {
    const double near = beside_m < 2 ? 0.5 * beside_m : (beside_m < 6 ? 1 : 0.15);
    return near * std::min(1.0, meadows(x, y));
  };
  const auto mowed = [](double, double, double beside_m) { return beside_m < 2 ? 1.0 : 0.15; };
  planter.sow(set.tussocks, p.tussocks_per_m2, tall, seed_for(p.seed, kTallGrass));
  planter.sow(set.mowed, p.mowed_per_m2, mowed, seed_for(p.seed, kMowedGrass));
  site.world_from_sensor = drive(site.terrain, p.drive);
  return site;
}

FlatSite flatten(const Site& site) {
  FlatSite flat;
  flat.model.ground =
      site.terrain.mesh(site.parameters.ground_spacing_m, site.parameters.ground_margin_m);
  flat.model.fitter = "test_site";
  const size_t n = site.placements.size();
  std::vector<size_t> vertex(n + 1, 0), triangle(n + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const auto& mesh = site.prototypes[site.placements[i].prototype].plant.mesh;
    vertex[i + 1] = vertex[i] + mesh.vertices.size();
    triangle[i + 1] = triangle[i] + mesh.size();
  }
  require(vertex[n] < UINT32_MAX, "site: too many vertices for one world");
  elements::TriangleMesh& surface = flat.model.surface;
  surface.vertices.resize(vertex[n]);
  surface.triangles.resize(triangle[n]);
  surface.hit.resize(triangle[n]);
  flat.label.resize(flat.model.size(), elements::Class::kGround);
  flat.instance.resize(flat.model.size(), 0);
  flat.part.resize(flat.model.size(), Part::kGround);
  parallel_for(n, 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      place(site, site.placements[i], vertex[i], triangle[i], flat);
    }
  });
  return flat;
}

}  // namespace underbrush::test_site
