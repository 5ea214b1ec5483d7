#include "underbrush/sensor/risley.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "io/temporary.hpp"
#include "sensor/wedge_oracle.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/rng.hpp"
#include "underbrush/sensor/angles.hpp"
#include "underbrush/sensor/pattern.hpp"

namespace underbrush::sensor {
namespace {

Risley behind(const std::vector<Wedge>& wedges, double pulse_hz) {
  Risley r;
  r.pulse_hz = pulse_hz;
  r.lasers.emplace_back();
  for (const Wedge& w : wedges) {
    r.lasers[0].prisms.push_back({w.hz, w.angle_deg * M_PI / 180, w.index});
  }
  return r;
}

Vec3 direction(const Risley& r, uint64_t k) {
  const Shot s = r.shot(k);
  return unit_vector(s.azimuth_rad, s.elevation_rad);
}

/// The widest azimuth, elevation and angle to x (degrees) of shots.
Vec3 widest(const Risley& r, uint64_t shots) {
  Vec3 out = Vec3::Zero();
  for (uint64_t k = 0; k < shots; ++k) {
    const Vec3 d = direction(r, k);
    const Vec3 angles(std::atan2(d.y(), d.x()), std::atan2(d.z(), d.x()), std::acos(d.x()));
    out = out.cwiseMax(angles.cwiseAbs() * 180 / M_PI);
  }
  return out;
}

TEST(Risley, OnePrismDeflectsByTheClosedFormOfEachOfItsSides) {
  const double a = 20 * M_PI / 180, n = 1.51;
  const Shot front = behind({{0, 20, n}}, 1).shot(0), back = behind({{0, -20, n}}, 1).shot(0);
  EXPECT_NEAR(front.elevation_rad, -std::asin(n * std::sin(a - std::asin(std::sin(a) / n))), 1e-12);
  EXPECT_NEAR(back.elevation_rad, -(std::asin(n * std::sin(a)) - a), 1e-12);
  EXPECT_NEAR(front.azimuth_rad, 0, 1e-12);
}

// Law: thin prisms draw the rosette Σ (n − 1) α (sin ωt, cos ωt), and errors are of third order.
TEST(Risley, ThinPrismsDrawTheRosetteOfTheFirstOrder) {
  for (const double scale : {0.5, 0.05}) {
    const std::vector<Wedge> wedges{{-121.5657, 2 * scale, 1.51}, {77.743, -1.5 * scale, 1.6}};
    const Risley r = behind(wedges, 1e4);
    for (uint64_t k = 0; k < 5000; k += 13) {
      Vec3 rose(1, 0, 0);
      for (const Wedge& w : wedges) {
        const double small = (w.index - 1) * std::abs(w.angle_deg) * M_PI / 180;
        const double turn = 2 * M_PI * w.hz * double(k) / 1e4;
        rose += small * Vec3(0, std::sin(turn), -std::cos(turn));
      }
      ASSERT_LT((direction(r, k) - rose.normalized()).norm(), 5e-5 * std::pow(scale, 3)) << k;
    }
  }
}

TEST(Risley, BeamsAreThoseOfSnellsLawAtEveryFace) {
  Stream random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Wedge> wedges;
    for (size_t k = 0; k < 2 + random.below(2); ++k) {
      wedges.push_back(
          {random.uniform(-200, 200), random.uniform(-18, 18), random.uniform(1.3, 1.6)});
    }
    Risley r = behind(wedges, 40000);
    r.start_s = random.uniform(0, 100);
    const Vec3 incident = Vec3(random.uniform(-0.05, 0.05), 1, 0.02).normalized();
    r.lasers[0].direction = from_helios(incident);
    r.lasers[0].sensor_from_laser = Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized());
    r.check();
    const uint64_t k = random.below(100000);
    const Vec3 expected = behind_wedges(wedges, r.start_s + double(k) / 40000, incident);
    EXPECT_LT((direction(r, k) - r.lasers[0].sensor_from_laser * from_helios(expected)).norm(),
              1e-9);
    EXPECT_EQ(r.shot(k).time_s, double(k) / 40000);
  }
}

// The fields of view that the makers state, with the prisms of the scanners of HELIOS++.
TEST(Risley, FieldsOfViewAreTheMakers) {
  const Risley mid40 = behind({{-121.5657, 18.7481, 1.51}, {77.743, 17.9634, 1.51}}, 1e5);
  EXPECT_NEAR(2 * widest(mid40, 100000).z(), 38.4, 0.2);
  const Risley mid70 = behind({{-77.7333, -29.7, 1.5095}, {121.5667, 29.7, 1.5095}}, 1e5);
  EXPECT_NEAR(2 * widest(mid70, 100000).z(), 70.4, 0.2);
  Risley avia = behind(
      {{-131.5463, 30.8856, 1.51}, {40.8032, 29.7735, 1.51}, {213.1611, 3.1351, 1.51}}, 40000);
  const std::vector<Prism> prisms = avia.lasers[0].prisms;
  avia.lasers.clear();
  for (const double y : {0.05216, 0.03238, 0.0108, -0.0108, -0.03238, -0.053}) {
    avia.lasers.push_back({Vec3(1, y, 0).normalized(), Eigen::Quaterniond::Identity(), prisms});
  }
  const Vec3 field = 2 * widest(avia, 240000);
  EXPECT_NEAR(field.x(), 77.2, 0.3);
  EXPECT_NEAR(field.y(), 70.4, 0.3);
}

TEST(Risley, ARoseRepeatsAfterTheCommonPeriodOfItsRotors) {
  const Risley r = behind({{50, -27, 1.51}, {-50, 29, 1.51}, {-130, 3, 1.51}}, 10000);
  for (uint64_t k = 0; k < 1000; ++k) {  // The common period is 0.1 s, which is 1000 pulses.
    ASSERT_LT((direction(r, k) - direction(r, k + 1000 * 7)).norm(), 1e-10);
  }
  for (const uint64_t part : {200u, 500u}) {
    double farthest = 0;
    for (uint64_t k = 0; k < 1000; ++k) {
      farthest = std::max(farthest, (direction(r, k) - direction(r, k + part)).norm());
    }
    EXPECT_GT(farthest, 0.03) << part;
  }
}

class RisleyFile : public testing::Test {
 protected:
  std::string write(const std::string& pattern) {
    std::ofstream(path_) << "name: rose\nkind: risley\nmin_range_m: 1\nmax_range_m: 100\n" +
                                pattern;
    return path_;
  }
  std::string refused(const std::string& pattern) {
    try {
      load(write(pattern));
    } catch (const FormatError& e) {
      return e.place() + ": " + e.reason();
    }
    return "";
  }
  io::TemporaryFolder folder_;
  std::string path_ = (folder_ / "rose.yaml").string();
};

const std::string kRates = "rate_hz: 10\nshots_per_s: 1000\n";
const std::string kPrisms =
    "prisms: {rotor_hz: [-12, 7.7], angle_deg: [18, -17], index: [1.5, 1.6]}\n";

TEST_F(RisleyFile, LasersFireTogetherAndThePatternGoesOn) {
  const Sensor s = load(write(kRates + kPrisms +
                              "start_s: 0.25\nlasers:\n  - {direction: [1, 0.05, 0]}\n"
                              "  - {attitude: [0, 0, 0.6, 0.8]}\n"
                              "  - {prisms: {rotor_hz: [3], angle_deg: [9], index: [1.4]}}\n"));
  EXPECT_EQ(kind_name(s), "risley");
  EXPECT_EQ(s.beams_per_s(), 3000);
  const Trajectory still({{5, Pose{}}, {8, Pose{}}});
  const BeamLog log = beams(s, still, 5, 7.5);
  log.check();
  ASSERT_EQ(log.size(), 7500u);
  EXPECT_EQ(log.info.scans.size(), 25u);
  for (size_t i = 0; i < log.size(); i += 11) {
    const double t = double(i / 3) / 1000;
    ASSERT_NEAR(log.time_s[i], 5 + t, 1e-9);
    ASSERT_EQ(log.ring[i], i % 3);
    ASSERT_EQ(log.scan[i], i / 300);
    std::vector<Wedge> wedges{{-12, 18, 1.5}, {7.7, -17, 1.6}};
    if (i % 3 == 2) wedges = {{3, 9, 1.4}};
    Vec3 d(0, 1, 0);
    if (i % 3 == 0) d = Vec3(-0.05, 1, 0).normalized();
    d = from_helios(behind_wedges(wedges, 0.25 + t, d));
    if (i % 3 == 1) d = Eigen::Quaterniond(0.8, 0, 0, 0.6) * d;
    ASSERT_LT((log.direction[i].cast<double>() - d).norm(), 1e-6) << i;
  }
  PatternSource source(s, still, 5, 7.5, 777);
  BeamLog joined, chunk;
  while (source.next(chunk)) joined.append(chunk, 0, chunk.size());
  EXPECT_EQ(joined.direction, log.direction);
  EXPECT_EQ(joined.packet, log.packet);
}

TEST_F(RisleyFile, RefusesWhatNoBeamPassesAndWhatIsWrong) {
  EXPECT_EQ(refused(kRates + kPrisms), "");
  const auto prisms = [](const std::string& angles, const std::string& index) {
    return "prisms: {rotor_hz: [1, 2], angle_deg: [" + angles + "], index: [" + index + "]}\n";
  };
  EXPECT_EQ(refused(kRates + prisms("-20, -45", "1.5, 1.5")),
            ": sensor: a prism reflects a beam totally");
  EXPECT_NE(refused(kRates + prisms("1", "1, 1")).find("prisms.angle_deg"), std::string::npos);
  EXPECT_NE(refused(kRates + prisms("1, 2", "1")).find("prisms.index"), std::string::npos);
  for (const std::string& bad :
       {kRates, kPrisms, kRates + prisms("1, 90", "1, 1"), kRates + prisms("1, .nan", "1, 1"),
        kRates + prisms("1, 2", "0, 1"), "rate_hz: 1e-9\nshots_per_s: 1e5\n" + kPrisms,
        "rate_hz: 10\nshots_per_s: 0\n" + kPrisms, "rate_hz: 1e9\nshots_per_s: 1\n" + kPrisms,
        kRates + kPrisms + "start_s: -1\n", kRates + kPrisms + "lasers: []\n",
        kRates + kPrisms + "lasers: 3\n", kRates + kPrisms + "lasers: {direction: [1, 0, 0]}\n",
        kRates + kPrisms + "lasers: [{direction: [0, 0, 0]}]\n",
        kRates + kPrisms + "lasers: [{direction: [1, 0]}]\n",
        kRates + kPrisms + "lasers: [{attitude: [1, 0]}]\n",
        kRates + kPrisms + "lasers: [{attitude: [0, 0, 0, 0]}]\n",
        kRates + kPrisms + "lasers: [4]\n"}) {
    EXPECT_NE(refused(bad), "") << bad;
  }
}

}  // namespace
}  // namespace underbrush::sensor
