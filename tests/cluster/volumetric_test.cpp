// The promises of every fitter of ellipsoids, in one test body for all of them.
#include "underbrush/cluster/volumetric.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <ostream>

#include "underbrush/core/linear.hpp"
#include "underbrush/core/rng.hpp"

namespace {
std::atomic<size_t> live{0}, peak{0};
}  // namespace

// Counts the heap of this program to test the memory bound.
[[gnu::noinline]] void* operator new(size_t n) {
  void* p = std::malloc(n);
  if (!p) throw std::bad_alloc();
  const size_t now = live += malloc_usable_size(p);
  size_t before = peak;
  while (now > before && !peak.compare_exchange_weak(before, now)) {
  }
  return p;
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  if (p) live -= malloc_usable_size(p);
  std::free(p);
}
void operator delete(void* p, size_t) noexcept { operator delete(p); }

namespace underbrush::cluster {
namespace {

/// A fitter with settings.
struct Case {
  std::string label, fitter;
  VolumetricOptions options;
  bool any_order;  // whether the result is the same for any order of the points
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.label; }

std::vector<Case> cases() {
  VolumetricOptions coarse;  // some tens of points a cluster on the clouds below
  coarse.hierarchical.clusters_per_point = 0.03;
  coarse.top_down.min_points = 25;
  return {{"hierarchical", "hierarchical", coarse, false},
          {"voxel", "voxel", coarse, true},
          {"top_down", "top_down", coarse, true},
          {"bottom_up", "bottom_up", coarse, true}};
}

struct Cloud {
  std::vector<Vec3f> point, to_sensor;
  operator VolumetricPoints() const { return {point, to_sensor}; }
  void add(const Vec3& x) {
    point.push_back(x.cast<float>());
    to_sensor.push_back((Vec3(-20, 3, 4) - x).normalized().cast<float>());
  }
};

struct Blob {
  Vec3 mean;
  Mat3 root;  // Σ = root rootᵀ
};

std::vector<Blob> blobs(uint64_t seed) {
  Stream random(seed);
  std::vector<Blob> out;
  for (int k = 0; k < 12; ++k) {
    Blob b{Vec3(4.0 * (k % 4), 4.0 * (k / 4), 0), Mat3::Zero()};
    for (int i = 0; i < 9; ++i) b.root(i / 3, i % 3) = 0.15 * random.normal();
    b.mean.z() = random.uniform(0, 3);
    out.push_back(b);
  }
  return out;
}

Vec3 draw(const Blob& b, Stream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return b.mean + b.root * Vec3(x, y, z);
}

Cloud cloud_of(const std::vector<Blob>& blobs, int points, uint64_t seed) {
  Stream random(seed);
  Cloud out;
  for (const Blob& b : blobs) {
    for (int i = 0; i < points; ++i) out.add(draw(b, random));
  }
  return out;
}

double log_normal(const Vec3& x, const Vec3& mean, const Mat3& sigma) {
  const Mat3 l = cholesky(sigma);
  const Vec3 r = l.triangularView<Eigen::Lower>().solve(x - mean);
  const double root = l.diagonal().array().log().sum();
  return -0.5 * r.squaredNorm() - root - 1.5 * std::log(2 * M_PI);
}

double mahalanobis(const elements::Ellipsoid& e, const Vec3f& x) {
  const Vec3 r = (x - e.mean).cast<double>();
  return std::sqrt(r.dot(e.covariance_matrix().inverse() * r));
}

void expect_sound(const Volumes& v, const VolumetricOptions& options) {
  const double floor = options.ellipsoid.floor_of(1e9);
  for (const auto& e : v.ellipsoids) {
    ASSERT_TRUE(e.mean.allFinite());
    const Mat3 sigma = e.covariance_matrix();
    ASSERT_TRUE(sigma.allFinite());
    const double least = eigenvalues(sigma)[0];
    EXPECT_GE(least, 0.99 * floor * floor - 1e-6 * sigma.trace());
  }
}

class Volumetric : public testing::TestWithParam<Case> {
 protected:
  const Case& c() const { return GetParam(); }
  Clusters clusters(const Cloud& cloud) const {
    return clusters_of(c().fitter, cloud, c().options, 7);
  }
  Volumes fitted(const Cloud& cloud) const { return volumes(c().fitter, cloud, c().options, 7); }
};

TEST_P(Volumetric, EveryPointIsInOneClusterAndWithinItsReach) {
  const Cloud cloud = cloud_of(blobs(1), 300, 2);
  const Clusters found = clusters(cloud);
  const Volumes v = fitted(cloud);
  ASSERT_EQ(v.ellipsoids.size(), found.count);
  EXPECT_EQ(v.unclustered_points, 0u);
  expect_sound(v, c().options);
  size_t within = 0;
  std::vector<int> size(found.count);
  for (size_t i = 0; i < cloud.point.size(); ++i) {
    ASSERT_LT(found.group[i], found.count);
    ++size[found.group[i]];
    within += mahalanobis(v.ellipsoids[found.group[i]], cloud.point[i]) < 3;
  }
  for (int s : size) EXPECT_GT(s, 0);
  EXPECT_GT(double(within), 0.97 * double(cloud.point.size()));
}

TEST_P(Volumetric, AMixtureIsRecovered) {
  const std::vector<Blob> truth = blobs(3);
  const Cloud cloud = cloud_of(truth, 400, 4);
  const Clusters found = clusters(cloud);
  const Volumes v = fitted(cloud);
  std::vector<double> share(found.count);
  for (uint32_t g : found.group) share[g] += 1 / double(cloud.point.size());
  // The Kullback–Leibler divergence of the fitted mixture from the true one is estimated from new
  // points.
  Stream random(5);
  double divergence = 0;
  const int n = 1200;
  for (int i = 0; i < n; ++i) {
    const Vec3 x = draw(truth[size_t(i) % truth.size()], random);
    double f = 0, g = 0;
    for (const Blob& b : truth) {
      f += std::exp(log_normal(x, b.mean, b.root * b.root.transpose() + 1e-9 * Mat3::Identity())) /
           double(truth.size());
    }
    for (size_t k = 0; k < v.ellipsoids.size(); ++k) {
      const auto& e = v.ellipsoids[k];
      g += share[k] * std::exp(log_normal(x, e.mean.cast<double>(), e.covariance_matrix()));
    }
    divergence += std::log(f / std::max(g, 1e-6)) / n;
  }
  RecordProperty("divergence", std::to_string(divergence));
  EXPECT_LT(divergence, 0.6) << found.count << " clusters";
}

TEST_P(Volumetric, NoClusterSpansWhatIsFarApart) {
  const Cloud cloud = cloud_of(blobs(3), 200, 6);
  const Clusters found = clusters(cloud);
  std::vector<std::vector<size_t>> of_blob(found.count, std::vector<size_t>(12));
  for (size_t i = 0; i < cloud.point.size(); ++i) ++of_blob[found.group[i]][i / 200];
  size_t strangers = 0;
  for (const auto& n : of_blob) {
    size_t all = 0;
    for (size_t k : n) all += k;
    strangers += all - *std::max_element(n.begin(), n.end());
  }
  EXPECT_LE(strangers, cloud.point.size() / 100);
}

TEST_P(Volumetric, RunsAreTheSameToTheBit) {
  const Cloud cloud = cloud_of(blobs(8), 200, 9);
  const Clusters a = clusters(cloud), b = clusters(cloud);
  EXPECT_EQ(a.group, b.group);
  const Volumes v = fitted(cloud), w = fitted(cloud);
  for (size_t k = 0; k < v.ellipsoids.size(); ++k) {
    EXPECT_EQ(v.ellipsoids[k].mean, w.ellipsoids[k].mean);
    EXPECT_EQ(v.ellipsoids[k].covariance, w.ellipsoids[k].covariance);
  }
}

// Computes the share of the ellipsoids of `a` that are in `b` after a shift, with errors up to
// `tolerance`.
double share_found(const Volumes& a, const Volumes& b, const Vec3f& shift, float tolerance) {
  size_t n = 0;
  for (const auto& e : a.ellipsoids) {
    n += std::any_of(b.ellipsoids.begin(), b.ellipsoids.end(), [&](const auto& o) {
      bool same = (e.mean + shift - o.mean).norm() < tolerance;
      for (size_t k = 0; k < 6; ++k) {
        same = same && std::abs(e.covariance[k] - o.covariance[k]) < tolerance;
      }
      return same;
    });
  }
  return a.ellipsoids.empty() ? 1 : double(n) / double(a.ellipsoids.size());
}

TEST_P(Volumetric, OrderOfThePointsDoesNotMatterWherePromised) {
  if (!c().any_order) GTEST_SKIP() << "makes no such promise";
  const Cloud cloud = cloud_of(blobs(10), 200, 11);
  Cloud turned;
  for (size_t i = cloud.point.size(); i-- > 0;) {  // a fixed shuffle: 7 is prime to the size
    const size_t from = (7 * i + 3) % cloud.point.size();
    turned.point.push_back(cloud.point[from]);
    turned.to_sensor.push_back(cloud.to_sensor[from]);
  }
  const Volumes a = fitted(cloud), b = fitted(turned);
  EXPECT_EQ(a.ellipsoids.size(), b.ellipsoids.size());
  EXPECT_EQ(share_found(a, b, Vec3f::Zero(), 1e-5f), 1);
}

// Points move by a shift that is a multiple of every fitter's voxels and large enough to cost
// digits.
TEST_P(Volumetric, AShiftMovesTheEllipsoids) {
  Cloud cloud = cloud_of(blobs(12), 200, 13);
  for (Vec3f& p : cloud.point) p = (p * 1024).array().round() / 1024;  // exact after the shift
  const Vec3f shift(1536, -3072, 48);                                  // 0.3 m and 0.1 m divide it
  Cloud moved = cloud;
  for (Vec3f& p : moved.point) p += shift;
  const Volumes a = fitted(cloud), b = fitted(moved);
  EXPECT_NEAR(double(a.ellipsoids.size()), double(b.ellipsoids.size()),
              0.02 * double(a.ellipsoids.size()));
  EXPECT_GT(share_found(a, b, shift, 1e-3f), 0.95);
}

TEST_P(Volumetric, DegenerateTilesAreSound) {
  Cloud empty, one, same, line, plane, pair;
  one.add({1, 2, 3});
  pair.add({1, 2, 3});
  pair.add({30, 2, 3});
  for (int i = 0; i < 200; ++i) {
    same.add({1, 2, 3});
    line.add({0.01 * i, 0.02 * i, 0.005 * i});
    plane.add({0.05 * (i % 20), 0.05 * (i / 20), 1});
  }
  EXPECT_TRUE(fitted(empty).ellipsoids.empty());
  for (const Cloud* cloud : {&one, &pair, &same, &line, &plane}) {
    const Volumes v = fitted(*cloud);
    expect_sound(v, c().options);
    const bool few = cloud->point.size() < 3;
    EXPECT_TRUE(few ? v.ellipsoids.size() + v.unclustered_points >= 1 : !v.ellipsoids.empty());
    EXPECT_TRUE(few || v.unclustered_points == 0);
  }
  const Volumes v = fitted(same);
  ASSERT_EQ(v.ellipsoids.size(), 1u);
  EXPECT_LT((v.ellipsoids[0].mean - Vec3f(1, 2, 3)).norm(), 1e-6);
  const double floor = c().options.ellipsoid.floor_of(double(same.point.size()));
  EXPECT_NEAR(v.ellipsoids[0].covariance[0], floor * floor, 1e-6);
}

TEST_P(Volumetric, MemoryIsBoundedByThePoints) {
  const Cloud cloud = cloud_of(blobs(14), 4000, 15);
  const size_t before = live;
  peak = before;
  const Volumes v = fitted(cloud);
  const double bytes = double(peak - before) / double(cloud.point.size());
  RecordProperty("bytes_per_point", std::to_string(bytes));
  EXPECT_LT(bytes, 160);
}

INSTANTIATE_TEST_SUITE_P(All, Volumetric, testing::ValuesIn(cases()),
                         [](const auto& of) { return of.param.label; });

TEST(VolumetricFitters, AreFoundByNameAndRefuseBadOptions) {
  const Cloud cloud = cloud_of(blobs(1), 10, 1);
  EXPECT_THROW(volumes("magic", cloud, {}, 1), std::invalid_argument);
  VolumetricOptions o;
  o.voxel.side_m = 0;
  EXPECT_THROW(volumes("voxel", cloud, o, 1), std::invalid_argument);
  o.voxel.side_m = 1e-6;  // more cubes than the codes can number
  EXPECT_THROW(volumes("voxel", cloud, o, 1), std::invalid_argument);
  o.top_down.min_points = 0;
  EXPECT_THROW(volumes("top_down", cloud, o, 1), std::invalid_argument);
  o.bottom_up.largest_m = -1;
  EXPECT_THROW(volumes("bottom_up", cloud, o, 1), std::invalid_argument);
  o.hierarchical.clusters_per_point = 0;
  EXPECT_THROW(volumes("hierarchical", cloud, o, 1), std::invalid_argument);
}

TEST(BottomUp, KeepsTheDensityItWasAsked) {
  const Cloud cloud = cloud_of(blobs(17), 500, 18);
  uint32_t before = 0;
  for (const double density : {0.3, 0.6, 0.9, 1e9}) {
    BottomUpOptions o;
    o.least_density = density;
    const uint32_t count = bottom_up_clusters(cloud.point, o).count;
    EXPECT_GT(count, before) << density;
    before = count;
  }
  EXPECT_EQ(before, occupied_voxels(cloud.point, BottomUpOptions{}.cell_m).clusters.count);
}

TEST(Voxel, ClustersAreTheOccupiedCubes) {
  const Cloud cloud = cloud_of(blobs(19), 300, 20);
  const Voxels v = occupied_voxels(cloud.point, 0.3);
  const auto cube = [&](size_t i) {
    return (cloud.point[i].cast<double>().array() / 0.3).floor().matrix().eval();
  };
  for (size_t i = 0; i < cloud.point.size(); i += 17) {
    for (size_t j = 0; j < cloud.point.size(); ++j) {
      const Vec3 step = cube(j) - cube(i);
      EXPECT_EQ(v.clusters.group[i] == v.clusters.group[j], step.isZero());
      EXPECT_EQ(v.code[v.clusters.group[j]],
                v.code[v.clusters.group[i]] +
                    uint64_t(voxel_step(int(step.x()), int(step.y()), int(step.z()))));
    }
  }
}

}  // namespace
}  // namespace underbrush::cluster
