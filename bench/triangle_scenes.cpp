#include "triangle_scenes.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "trace_scenes.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/test_site/prototypes.hpp"

namespace underbrush::bench {
namespace {

constexpr double kSceneSideM = 100;
constexpr int kTreeKinds = 8, kLeaves = 5000, kBranches = 40;

Vec3 random_unit(Stream& random) {
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = random.normal();
  return v.normalized();
}

/// Returns a tree with a straight stem, branches, and leaves about the outer halves of these.
elements::TriangleMesh leafy_tree(uint64_t seed) {
  Stream random(seed);
  test_site::PlantMesh plant;
  const double height = random.uniform(7, 12);
  const auto stem = [&](double share) { return Vec3(0, 0, share * height); };
  const test_site::TubePoint axis[3] = {{stem(0), 0.15}, {stem(0.5), 0.1}, {stem(0.95), 0.01}};
  test_site::add_tube(plant, axis, 8);
  for (int b = 0; b < kBranches; ++b) {
    const double share = random.uniform(0.25, 0.9), angle = 2.399963229728653 * b;
    const double reach = 0.35 * height * (1.05 - share);
    const Vec3 out(reach * std::cos(angle), reach * std::sin(angle), 0.4 * reach);
    const test_site::TubePoint branch[2] = {{stem(share), 0.03}, {stem(share) + out, 0.003}};
    test_site::add_tube(plant, branch, 5);
    for (int k = 0; k < kLeaves / kBranches; ++k) {
      const Vec3 at = stem(share) + random.uniform(0.3, 1.05) * out +
                      0.15 * reach * random.uniform() * random_unit(random);
      const Vec3 along = random_unit(random);
      const double length = random.uniform(0.04, 0.09);
      const Vec3 normal = along.cross(random_unit(random)).normalized();
      test_site::add_leaf(plant, at, along, normal, length, 0.6 * length);
    }
  }
  return std::move(plant.mesh);
}

/// Adds the first `triangles` of a mesh, turned about the vertical.
void add(const elements::TriangleMesh& from, size_t triangles, const Vec3& where, double turn,
         elements::TriangleMesh& to) {
  const Mat3 rotation = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  const uint32_t first = uint32_t(to.vertices.size());
  for (const Vec3f& v : from.vertices) {
    to.vertices.push_back((rotation * v.cast<double>() + where).cast<float>());
  }
  for (size_t k = 0; k < triangles; ++k) {
    std::array<uint32_t, 3> corners = from.triangles[k];
    for (uint32_t& c : corners) c += first;
    to.triangles.push_back(corners);
  }
  to.hit.resize(to.size());
}

/// Plants `kinds` in turns until there are so many triangles, on a jittered grid outside the
/// corridor, or along the way where they are few.
void plant(const std::vector<elements::TriangleMesh>& kinds, size_t triangles,
           elements::TriangleMesh& to) {
  size_t count = 0;
  for (size_t sum = 0; sum < triangles; ++count) sum += kinds[count % kinds.size()].size();
  Stream random(5);
  const size_t across = size_t(std::ceil(std::sqrt(double(count))));
  const double cell = kSceneSideM / double(across);
  for (size_t i = 0; i < count; ++i) {
    double x = (double(i % across) + 0.5 + 0.35 * random.uniform(-1, 1)) * cell - kSceneSideM / 2;
    double y = (double(i / across) + 0.5 + 0.35 * random.uniform(-1, 1)) * cell - kSceneSideM / 2;
    if (count <= 40) {
      x = kSceneSideM * (0.84 * (double(i) + 0.5) / double(count) - 0.42);
      y = (i % 2 ? 1 : -1) * random.uniform(4, 10);
    }
    if (std::abs(y) < 3.2) y = std::copysign(3.2 + 0.8 * random.uniform(), y);
    const elements::TriangleMesh& kind = kinds[i % kinds.size()];
    add(kind, std::min(kind.size(), triangles - to.size()), Vec3(x, y, ground_z(x, y)),
        random.uniform(0, 2 * M_PI), to);
  }
}

std::vector<elements::TriangleMesh> kinds_of(const std::string& name) {
  std::vector<elements::TriangleMesh> kinds;
  if (name == "leaves") {
    for (uint64_t k = 0; k < kTreeKinds; ++k) kinds.push_back(leafy_tree(2000 + k));
    return kinds;
  }
  require(name == "plants", "there is no such world");
  const test_site::PrototypeSet set = test_site::make_prototypes(1);
  // One tree comes with two shrubs and two tussocks.
  for (uint32_t k = set.trees.begin; k < set.trees.end; ++k) {
    const auto take = [&](const test_site::PrototypeRange& range, uint32_t at) {
      kinds.push_back(set.prototypes[range.begin + at % (range.end - range.begin)].plant.mesh);
    };
    for (uint32_t twice : {0u, 1u}) take(set.tussocks, 2 * k + twice);
    for (uint32_t twice : {0u, 1u}) take(set.shrubs, 2 * k + twice);
    take(set.trees, k);
  }
  return kinds;
}

}  // namespace

elements::Model triangle_world(const std::string& name, size_t triangles) {
  elements::Model model;
  if (name == "terrain") {
    model.ground =
        ground_mesh(kSceneSideM, kSceneSideM / std::round(std::sqrt(double(triangles) / 2)));
  } else {
    model.ground = ground_mesh(kSceneSideM, 2);
    plant(kinds_of(name), triangles - std::min(triangles, model.ground.size()), model.surface);
  }
  model.ground.range_sigma_m = model.surface.range_sigma_m = 0.02;
  return model;
}

}  // namespace underbrush::bench
