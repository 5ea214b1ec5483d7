#include "underbrush/ground/segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include "data.hpp"
#include "underbrush/core/parallel.hpp"
#include "underbrush/core/rng.hpp"

namespace underbrush::ground {
namespace {

struct Site {
  std::vector<Vec3f> points;
  std::vector<uint8_t> ground;
};

/// Makes 60 m × 60 m of ground z(x, y) with noise, and boxes of scattered points that start 0.5 m
/// above it. The boxes hide the ground below them, as crowns and hedges do. The seed is 7.
template <class Height>
Site site(const Height& height, double box_m = 5) {
  Site s;
  Stream random(7);
  for (int i = 0; i < 40000; ++i) {
    const double x = random.uniform(-30, 30), y = random.uniform(-30, 30);
    const bool box = std::fmod(x + 30, 15) < box_m && std::fmod(y + 30, 15) < box_m;
    const double above = box ? random.uniform(0.5, 6) : 0.03 * random.normal();
    s.points.emplace_back(float(x), float(y), float(height(x, y) + above));
    s.ground.push_back(!box);
  }
  return s;
}

double agreement(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  size_t same = 0;
  for (size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
  return double(same) / double(a.size());
}

TEST(LowerEnvelope, FindsGroundOfAnySlopeUnderObjects) {
  for (double slope : {0.0, 0.2, 0.5, 1.0}) {
    const Site s = site([&](double x, double y) { return slope * x + 0.5 * slope * y; });
    EXPECT_GT(agreement(lower_envelope(s.points), s.ground), 0.995) << "slope " << slope;
  }
}

TEST(LowerEnvelope, FollowsHillsAndDitches) {
  const Site s =
      site([](double x, double y) { return 3 * std::sin(x / 8) + 2 * std::cos(y / 10); });
  EXPECT_GT(agreement(lower_envelope(s.points), s.ground), 0.99);
  const Site ditch = site([](double x, double) { return x > 8 && x < 11 ? -1.0 : 0.0; });
  // the edges of the ditch are lost
  EXPECT_GT(agreement(lower_envelope(ditch.points), ditch.ground), 0.93);
}

TEST(LowerEnvelope, ReachesUnderObjectsAsWideAsTheCoarsestCell) {
  const Site s = site([](double x, double) { return 0.1 * x; }, 12);
  EXPECT_GT(agreement(lower_envelope(s.points), s.ground), 0.97);
}

TEST(LowerEnvelope, PointsBelowGroundNeitherCountNorPull) {
  Site s = site([](double, double) { return 0.0; });
  Stream random(8);
  for (int i = 0; i < 60; ++i) {
    s.points.emplace_back(float(random.uniform(-30, 30)), float(random.uniform(-30, 30)),
                          float(-random.uniform(1, 8)));
    s.ground.push_back(0);
  }
  EXPECT_GT(agreement(lower_envelope(s.points), s.ground), 0.995);
}

TEST(LowerEnvelope, ShiftsAndThreadsChangeNothing) {
  const Site s = site([](double x, double) { return 0.25 * x; });
  std::vector<Vec3f> shifted = s.points;
  for (Vec3f& p : shifted) p += Vec3f(4096, -2048, 512);
  set_threads(1);
  const std::vector<uint8_t> one = lower_envelope(s.points);
  const std::vector<uint8_t> phi_one = spherical_variance(s.points);
  set_threads(0);
  EXPECT_EQ(one, lower_envelope(s.points));
  EXPECT_EQ(phi_one, spherical_variance(s.points));
  EXPECT_GT(agreement(one, lower_envelope(shifted)), 0.9995);  // float rounding at the band's edge
}

TEST(LowerEnvelope, GrassIsGroundOnlyWhereBeamsReachItsFloor) {
  Stream random(11);
  std::vector<Vec3f> grass, floor;
  for (int i = 0; i < 40000; ++i) {
    const float x = float(random.uniform(-8, 8)), y = float(random.uniform(-8, 8));
    grass.emplace_back(x, y, float(random.uniform(0, 0.6)));
    if (i % 2 == 0) floor.emplace_back(y, x, float(0.02 * random.normal()));
  }
  const auto share = [](std::span<const uint8_t> flags) {
    return double(std::count(flags.begin(), flags.end(), 1)) / double(flags.size());
  };
  EXPECT_LT(share(lower_envelope(grass)), 0.01);
  EXPECT_GT(share(lower_envelope(grass, {.layer = 0})), 0.15);
  std::vector<Vec3f> both = floor;
  both.insert(both.end(), grass.begin(), grass.end());
  // Where the floor is seen, the demand for a layer takes little away.
  EXPECT_GT(agreement(lower_envelope(both), lower_envelope(both, {.layer = 0})), 0.95);
  const std::vector<uint8_t> found = lower_envelope(both, {.above_m = 0.05});
  EXPECT_GT(share(std::span(found).first(floor.size())), 0.85);
  EXPECT_LT(share(std::span(found).subspan(floor.size())), 0.12);
}

TEST(LowerEnvelope, WallsAndHangingCrownsLeaveTheGroundBesideThem) {
  Stream random(12);
  Site s;
  for (int i = 0; i < 60000; ++i) {
    const double x = random.uniform(-20, 20), y = random.uniform(-20, 20);
    const double kind = random.uniform(0, 1);
    const bool is_wall = kind<0.2, is_crown = kind> 0.7 && y > 10;
    const double z = is_wall    ? random.uniform(0.25, 3)
                     : is_crown ? random.uniform(0.3, 4)
                                : 0.02 * random.normal();
    s.points.emplace_back(float(x), float(is_wall ? 0.02 * random.normal() : y), float(z));
    s.ground.push_back(!is_wall && !is_crown);
  }
  const std::vector<uint8_t> found = lower_envelope(s.points);
  double ground = 0, lost = 0, beside = 0, lost_beside = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    if (!s.ground[i]) {
      EXPECT_EQ(found[i], 0) << s.points[i].transpose();
      continue;
    }
    const bool is_beside = std::abs(s.points[i].y()) < 1;
    (is_beside ? beside : ground) += 1;
    (is_beside ? lost_beside : lost) += !found[i];
  }
  EXPECT_LT(lost, 0.005 * ground);
  EXPECT_LT(lost_beside, 0.05 * beside);
}

TEST(LowerEnvelope, DegenerateTiles) {
  EXPECT_TRUE(lower_envelope({}).empty());
  const float nan = std::nanf("");
  const std::vector<Vec3f> points{{1, 2, 3}, {nan, 0, 0}, {1, 2, 3}, {1, 2, 9}};
  EXPECT_EQ(lower_envelope(points), (std::vector<uint8_t>{1, 0, 1, 0}));
  EXPECT_EQ(lower_envelope(std::vector<Vec3f>{{nan, nan, nan}}), std::vector<uint8_t>{0});
  EXPECT_THROW(lower_envelope(std::vector<Vec3f>{{0, 0, 0}, {1e6f, 1e6f, 0}}),
               std::invalid_argument);
  EXPECT_THROW(lower_envelope(points, {.cell_m = 0}), std::invalid_argument);
  EXPECT_THROW(lower_envelope(points, {.layer = -1}), std::invalid_argument);
}

TEST(SphericalVariance, IsThatOfThePopulation) {
  // A flat disc has 0, a ball 1/3, and an ellipsoid with σ² = 1, 4, 4 has 1/9. All neighbours are
  // used.
  Stream random(9);
  for (const auto& [scale, phi] : std::vector<std::pair<Vec3f, double>>{
           {{1, 1, 0}, 0}, {{1, 1, 1}, 1 / 3.0}, {{2, 1, 2}, 1 / 9.0}}) {
    std::vector<Vec3f> points;
    for (int i = 0; i < 500; ++i) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      points.push_back(scale.cwiseProduct(Vec3f(float(x), float(y), float(z))));
    }
    const std::vector<float> found =
        spherical_variances(points, {.neighbours = 500, .radius_m = 100, .smooth_neighbours = 0});
    EXPECT_NEAR(found[0], phi, 0.045);
    EXPECT_NEAR(found[123], found[0], 1e-5);
  }
}

TEST(SphericalVariance, SmoothingIsTheWeightedMean) {
  const std::vector<Vec3f> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                  {0, 0, 1}, {3, 3, 3}, {50, 0, 0}};
  SphericalVarianceOptions o{.neighbours = 4, .smooth_neighbours = 0};
  const std::vector<float> raw = spherical_variances(points, o);
  EXPECT_FLOAT_EQ(raw[5], 0.01f);  // an isolated point has the default
  o.smooth_neighbours = 100;
  const std::vector<float> smooth = spherical_variances(points, o);
  double sum = 0, weights = 0;
  for (size_t i = 0; i < 5; ++i) {
    const double w = std::exp(-double((points[i] - points[0]).squaredNorm()) / 100);
    sum += w * double(raw[i]);
    weights += w;
  }
  EXPECT_NEAR(smooth[0], sum / weights, 1e-6);
  EXPECT_FLOAT_EQ(smooth[5], raw[5]);
}

TEST(SphericalVariance, DegenerateClouds) {
  EXPECT_TRUE(spherical_variances({}).empty());
  const float nan = std::nanf("");
  const std::vector<float> phi = spherical_variances(
      std::vector<Vec3f>{{0, 0, nan}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  EXPECT_TRUE(std::isnan(phi[0]));
  EXPECT_EQ(phi[1], 0);  // a point without extent counts as flat
  EXPECT_THROW(spherical_variances({}, {.neighbours = 0}), std::invalid_argument);
}

TEST(Segment, GoesByName) {
  const Site s = site([](double, double) { return 0.0; });
  EXPECT_EQ(segment(s.points), lower_envelope(s.points));
  SegmentOptions options;
  options.method = "spherical_variance";
  EXPECT_EQ(segment(s.points, options), spherical_variance(s.points));
  options.method = "magic";
  EXPECT_THROW(segment(s.points, options), std::invalid_argument);
}

template <class T>
std::vector<T> load(const std::string& name) {
  const std::string bytes = test::read_file(test::data_folder() / name);
  std::vector<T> data(bytes.size() / sizeof(T));
  std::memcpy(data.data(), bytes.data(), data.size() * sizeof(T));
  return data;
}

struct Score {
  double iou, vegetation_recall;
};

Score score(const std::vector<uint8_t>& found, const std::vector<int>& label,
            const std::set<int>& ground, const std::set<int>& vegetation) {
  double both = 0, either = 0, plants = 0, plants_found = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const bool is = ground.count(label[i]), says = found[i];
    both += is && says;
    either += is || says;
    plants += double(vegetation.count(label[i]));
    plants_found += vegetation.count(label[i]) && !says;
  }
  return {both / either, plants_found / plants};
}

TEST(Segment, AgreesWithPeoplesLabels) {
  UNDERBRUSH_NEEDS_DATA("kitti00_labelled");
  UNDERBRUSH_NEEDS_DATA("rellis_000104");
  struct {
    const char *points, *labels;
    std::set<int> ground, ignored, vegetation;
    double iou, vegetation_recall;
  } sets[] = {{"kitti00_labelled/kitti00_000000.bin",
               "kitti00_labelled/kitti00_000000.label",
               {40, 44, 48, 49, 60, 72},
               {0, 1},
               {70, 71},
               0.94,
               0.9},
              {"rellis_000104/000104.bin",
               "rellis_000104/000104.label",
               {1, 3, 10, 23, 31, 33},
               {0},
               {4, 19},
               0.88,
               0.81}};
  for (const auto& s : sets) {
    const std::vector<float> xyzi = load<float>(s.points);
    const std::vector<uint32_t> labels = load<uint32_t>(s.labels);
    std::vector<Vec3f> points;
    std::vector<int> label;
    for (size_t i = 0; i < labels.size(); ++i) {
      const Vec3f p(xyzi[4 * i], xyzi[4 * i + 1], xyzi[4 * i + 2]);
      if (p.isZero() || s.ignored.count(int(labels[i] & 0xffff))) continue;
      points.push_back(p);
      label.push_back(int(labels[i] & 0xffff));
    }
    const Score envelope = score(lower_envelope(points), label, s.ground, s.vegetation);
    const Score variance = score(spherical_variance(points), label, s.ground, s.vegetation);
    for (const auto& [method, found] :
         {std::pair("lower_envelope", envelope), std::pair("spherical_variance", variance)}) {
      std::printf("%s %s: IoU %.3f, vegetation recall %.3f\n", s.points, method, found.iou,
                  found.vegetation_recall);
    }
    EXPECT_GT(envelope.iou, s.iou) << s.points;
    EXPECT_GT(envelope.vegetation_recall, s.vegetation_recall) << s.points;
    EXPECT_GT(envelope.iou, variance.iou) << s.points;
  }
}

}  // namespace
}  // namespace underbrush::ground
