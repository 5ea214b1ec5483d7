#include "trace_scenes.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::bench {
namespace {

constexpr double kTau = 2.5, kSideM = 100, kCorridorM = 3.2;

Mat3 random_rotation(Stream& random) {
  double q[4];
  for (double& x : q) x = random.normal();
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

elements::Ellipsoid leaf_cluster(Stream& random, const Vec3& mean) {
  Vec3 s;
  for (int k = 0; k < 3; ++k) s[k] = 0.03 * std::pow(5.0, random.uniform());  // 3 to 15 cm
  const Mat3 r = random_rotation(random);
  elements::Ellipsoid e;
  e.mean = mean.cast<float>();
  e.set_covariance(r * s.cwiseAbs2().asDiagonal() * r.transpose());
  e.hit.p = float(random.uniform(0.1, 0.9));
  return e;
}

/// Adds a trunk, and a crown denser at its shell, at the origin.
std::vector<elements::Ellipsoid> tree(uint64_t seed, int ellipsoids) {
  Stream random(seed);
  std::vector<elements::Ellipsoid> out;
  const int trunk = std::max(8, ellipsoids / 200);
  for (int i = 0; i < trunk; ++i) {
    elements::Ellipsoid e;
    e.mean = Vec3f(0, 0, 0.1f + 3.5f * float(i) / float(trunk));
    e.set_covariance(Vec3(0.0036, 0.0036, 0.0225).asDiagonal());
    e.hit.p = 0.9f;
    out.push_back(e);
  }
  while (out.size() < size_t(ellipsoids)) {
    Vec3 at;
    for (int k = 0; k < 3; ++k) at[k] = random.uniform(-1, 1);
    const double q = at.squaredNorm();
    if (q > 1 || random.uniform() > 0.25 + 0.75 * q) continue;
    out.push_back(leaf_cluster(random, Vec3(1.8 * at.x(), 1.8 * at.y(), 4 + 3.3 * at.z())));
  }
  return out;
}

constexpr int kKinds = 16;
int tree_size(int kind) { return 2000 + 200 * kind; }

/// Returns where trees stand: on a jittered grid of `n` places, outside the corridor.
std::vector<Vec3> places(size_t n, double side_m, Stream& random) {
  const size_t across = size_t(std::ceil(std::sqrt(double(n))));
  const double cell = side_m / double(across);
  std::vector<Vec3> out;
  for (size_t i = 0; i < n; ++i) {
    double x = (double(i % across) + 0.5 + 0.35 * random.uniform(-1, 1)) * cell - side_m / 2;
    double y = (double(i / across) + 0.5 + 0.35 * random.uniform(-1, 1)) * cell - side_m / 2;
    if (std::abs(y) < kCorridorM) y = std::copysign(kCorridorM + 0.8 * random.uniform(), y);
    out.emplace_back(x, y, ground_z(x, y));
  }
  return out;
}

elements::Model bare(double side_m) {
  elements::Model model;
  model.tau = kTau;
  model.ground = ground_mesh(side_m, 0.25);
  model.ground.range_sigma_m = 0.02;
  return model;
}

}  // namespace

double ground_z(double x, double y) {
  return 0.8 * std::sin(x * 0.11) * std::cos(y * 0.083) + 0.35 * std::sin(0.37 * x + 0.21 * y) +
         0.06 * std::sin(1.9 * x) * std::sin(2.3 * y);
}

elements::TriangleMesh ground_mesh(double side_m, double cell_m) {
  elements::TriangleMesh mesh;
  const uint32_t n = uint32_t(std::lround(side_m / cell_m));
  for (uint32_t j = 0; j <= n; ++j) {
    for (uint32_t i = 0; i <= n; ++i) {
      const double x = i * cell_m - side_m / 2, y = j * cell_m - side_m / 2;
      mesh.vertices.emplace_back(float(x), float(y), float(ground_z(x, y)));
    }
  }
  for (uint32_t j = 0; j < n; ++j) {
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  }
  mesh.hit.resize(mesh.size());
  return mesh;
}

elements::Model forest(size_t ellipsoids) {
  elements::Model model = bare(kSideM);
  std::vector<std::vector<elements::Ellipsoid>> kinds;
  kinds.reserve(kKinds);
  for (int k = 0; k < kKinds; ++k) kinds.push_back(tree(1000 + uint64_t(k), tree_size(k)));
  size_t trees = 0;
  for (size_t sum = 0; sum < ellipsoids; ++trees) sum += kinds[trees * 7 % kKinds].size();
  Stream random(5);
  std::vector<Vec3> where = places(trees, kSideM, random);
  // A few trees stand along the way, so that they are seen.
  for (size_t i = 0; trees <= 40 && i < trees; ++i) {
    const double x = kSideM * (0.84 * (double(i) + 0.5) / double(trees) - 0.42);
    const double y = (i % 2 ? 1 : -1) * (4 + (trees > 4 ? 6 * random.uniform() : 0));
    where[i] = Vec3(x, y, ground_z(x, y));
  }
  model.ellipsoids.reserve(ellipsoids);
  for (size_t i = 0; i < trees; ++i) {
    const Mat3 turn =
        Eigen::AngleAxisd(random.uniform(0, 2 * M_PI), Vec3::UnitZ()).toRotationMatrix();
    for (elements::Ellipsoid e : kinds[i * 7 % kKinds]) {
      if (model.ellipsoids.size() == ellipsoids) break;
      e.mean = (turn * e.mean.cast<double>() + where[i]).cast<float>();
      e.set_covariance(turn * e.covariance_matrix() * turn.transpose());
      model.ellipsoids.push_back(e);
    }
  }
  return model;
}

elements::Model field(size_t ellipsoids) {
  elements::Model model = bare(kSideM);
  Stream random(6);
  for (size_t i = 0; i < ellipsoids; ++i) {
    const double x = kSideM * (random.uniform() - 0.5), y = kSideM * (random.uniform() - 0.5);
    elements::Ellipsoid e = leaf_cluster(random, Vec3(x, y, ground_z(x, y) + 0.1));
    e.set_covariance(Vec3(0.0004, 0.0004, 0.0064).asDiagonal());
    model.ellipsoids.push_back(e);
  }
  return model;
}

elements::Scene planted(size_t instances) {
  const double side = 5.9 * std::sqrt(double(instances));
  elements::Scene scene;
  scene.models.push_back(bare(std::min(side, 500.0)));
  scene.instances.emplace_back();
  for (int k = 0; k < kKinds; ++k) {
    elements::Model kind;
    kind.tau = kTau;
    kind.ellipsoids = tree(1000 + uint64_t(k), tree_size(k));
    scene.models.push_back(std::move(kind));
  }
  Stream random(5);
  const std::vector<Vec3> where = places(instances, side, random);
  for (size_t i = 0; i < instances; ++i) {
    elements::Instance placed;
    placed.model = 1 + uint32_t(i * 7 % kKinds);
    placed.scale = float(random.uniform(0.85, 1.15));
    placed.world_from_model.rotation =
        Eigen::AngleAxisd(random.uniform(0, 2 * M_PI), Vec3::UnitZ());
    placed.world_from_model.translation = where[i];
    scene.instances.push_back(placed);
  }
  return scene;
}

elements::TriangleMesh as_triangles(const elements::Model& model) {
  elements::TriangleMesh mesh = model.ground;
  Stream random(9);
  for (const elements::Ellipsoid& e : model.ellipsoids) {
    // A flat patch shows half its area on average, an ellipsoid π τ² times the square of its size.
    const double size2 = std::cbrt(e.covariance_matrix().determinant());
    const double area = 2 * double(e.hit.p) * M_PI * kTau * kTau * size2;
    const double radius = std::sqrt(area * 4 / (3 * std::sqrt(3.0)));
    const Mat3 turn = random_rotation(random);
    const uint32_t first = uint32_t(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * M_PI / 3 * k;
      mesh.vertices.push_back(
          e.mean +
          (turn * Vec3(radius * std::cos(angle), radius * std::sin(angle), 0)).cast<float>());
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.hit.resize(mesh.size());
  return mesh;
}

std::vector<Ray> drive(const char* sensor, int revolutions, int sub_rays) {
  std::vector<StampedPose> poses;
  const double last = 0.1 * revolutions;
  for (int k = 0; k <= 20 * revolutions; ++k) {
    StampedPose p;
    p.time_s = last * k / (20.0 * revolutions);
    const double x = 10 * (p.time_s - last / 2);  // 10 m/s
    p.world_from_sensor.translation = Vec3(x, 0.7 * std::sin(0.1 * x), ground_z(x, 0) + 2);
    poses.push_back(p);
  }
  const Trajectory trajectory(poses);
  const BeamLog beams = sensor::beams(sensor::load(sensor), trajectory, 0, last);
  std::vector<Ray> rays;
  for (size_t i = 0; i < beams.size(); ++i) {
    const Vec3 d = beams.direction[i].cast<double>().normalized();
    const Vec3 u = d.unitOrthogonal(), v = d.cross(u);
    for (int k = 0; k < sub_rays; ++k) {
      const double r = sub_rays == 1 ? 0 : 0.0015 * std::sqrt((k + 0.5) / sub_rays);
      const double angle = k * 2.399963229728653;  // the golden angle
      rays.push_back(
          {beams.origin[i], (d + r * (std::cos(angle) * u + std::sin(angle) * v)).normalized()});
    }
  }
  return rays;
}

}  // namespace underbrush::bench
