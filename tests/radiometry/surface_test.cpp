// Tests of reflection by surfaces and leaves, and of attenuation by air.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/core/leaf_angle_distribution.hpp"
#include "underbrush/elements/classes.hpp"
#include "underbrush/radiometry/brdf.hpp"
#include "underbrush/radiometry/link_budget.hpp"
#include "underbrush/radiometry/materials.hpp"

namespace underbrush::radiometry {
namespace {

Vec3 direction(double zenith, double azimuth) {
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth),
          std::cos(zenith)};
}

std::vector<SurfaceModel> surfaces() {
  return {{},
          {Brdf::kOrenNayar, 0, 0, 0},
          {Brdf::kOrenNayar, 0.5, 0, 0},
          {Brdf::kPhong, 0, 0.5, 10},
          {Brdf::kPhong, 0, 1, 50}};
}

TEST(Brdf, IsReciprocalAndReflectsNoMoreThanItReceives) {
  for (const SurfaceModel& s : surfaces()) {
    for (const double zenith : {0.0, 0.4, 0.9, 1.4}) {
      const Vec3 in = direction(zenith, 0.3);
      double albedo = 0;
      constexpr int kN = 150;
      for (int i = 0; i < kN; ++i) {
        for (int j = 0; j < 2 * kN; ++j) {
          const double t = (i + 0.5) * M_PI_2 / kN, a = (j + 0.5) * M_PI / kN;
          const Vec3 out = direction(t, a);
          const double f = brdf(s, in, out, Vec3::UnitZ());
          ASSERT_NEAR(f, brdf(s, out, in, Vec3::UnitZ()), 1e-12 + 1e-9 * f);
          albedo += f * std::cos(t) * std::sin(t) * M_PI_2 / kN * M_PI / kN;
        }
      }
      EXPECT_LT(albedo, 1.02) << int(s.brdf) << " at " << zenith;
      if (s.brdf == Brdf::kLambert) {
        EXPECT_NEAR(albedo, 1, 1e-3);
      }
      if (s.brdf == Brdf::kPhong && zenith == 0) {
        EXPECT_NEAR(albedo, 1, 1e-2);
      }
    }
    EXPECT_EQ(brdf(s, Vec3::UnitZ(), -Vec3::UnitZ(), Vec3::UnitZ()), 0);
  }
}

TEST(Brdf, BackscatterIsTheBrdfWithBothDirectionsOne) {
  for (const SurfaceModel& s : surfaces()) {
    for (double zenith = 0; zenith < 1.5; zenith += 0.05) {
      const Vec3 d = direction(zenith, 1);
      const double c = std::cos(zenith);
      EXPECT_NEAR(backscatter(s, c), M_PI * c * brdf(s, d, d, Vec3::UnitZ()), 1e-9);
    }
    EXPECT_EQ(backscatter(s, 0), 0);
    EXPECT_EQ(backscatter(s, -0.3), 0);
  }
  EXPECT_DOUBLE_EQ(backscatter({}, 0.5), 0.5);
  // Without roughness Oren–Nayar is Lambert. With it a grazing beam gets more back.
  EXPECT_NEAR(backscatter({Brdf::kOrenNayar, 0, 0, 0}, 0.3), 0.3, 1e-12);
  EXPECT_GT(backscatter({Brdf::kOrenNayar, 0.5, 0, 0}, 0.1), 0.3);
  EXPECT_LT(backscatter({Brdf::kOrenNayar, 0.5, 0, 0}, 1), 0.9);
  // A mirror-like surface is bright when perpendicular and dark otherwise.
  EXPECT_NEAR(backscatter({Brdf::kPhong, 0, 1, 100}, 1), 51, 1e-9);
  EXPECT_LT(backscatter({Brdf::kPhong, 0, 1, 100}, std::cos(30 * kDegree)), 1e-3);
}

// The slow references are sums over the density of leaf angles and over azimuth.
TEST(LeafAngleDistribution, ClosedFormsAreTheIntegralsOverTheLeafAngles) {
  for (const double shape : {0.1, 0.7, 0.99999, 1.0, 1.00002, 1.001, 2.5, 10.0}) {
    const LeafAngleDistribution leaves(shape);
    for (const double beam : {0.0, 0.5, 1.1, M_PI_2}) {
      double area = 0, shown = 0, square = 0;
      constexpr int kN = 2000, kTurns = 64;
      for (int i = 0; i < kN; ++i) {
        const double t = (i + 0.5) * M_PI_2 / kN, g = leaves.density(t) * M_PI_2 / kN;
        area += g;
        for (int j = 0; j < kTurns; ++j) {
          const double c = direction(t, (j + 0.5) * 2 * M_PI / kTurns).dot(direction(beam, 0));
          shown += g * std::abs(c) / kTurns;
          square += g * c * c / kTurns;
        }
      }
      EXPECT_NEAR(area, 1, 2e-3) << shape;
      EXPECT_NEAR(leaves.projection(std::cos(beam)), shown, 3e-3) << shape << " " << beam;
      EXPECT_NEAR(leaves.backscatter(std::cos(beam)), square / shown, 4e-3) << shape << " " << beam;
      EXPECT_EQ(leaves.projection(-std::cos(beam)), leaves.projection(std::cos(beam)));
    }
  }
}

TEST(LeafAngleDistribution, SphericalLeavesShowHalfTheirAreaAndReturnTwoThirds) {
  const LeafAngleDistribution leaves;
  for (double c = 0; c <= 1; c += 0.1) {
    EXPECT_NEAR(leaves.projection(c), 0.5, 1e-12);
    EXPECT_NEAR(leaves.backscatter(c), 2.0 / 3, 1e-12);
  }
  // Flat leaves seen from above are perpendicular to the beam.
  EXPECT_NEAR(LeafAngleDistribution(100).backscatter(1), 1, 2e-3);
  EXPECT_NEAR(LeafAngleDistribution(100).projection(1), 1, 2e-3);
  EXPECT_THROW(LeafAngleDistribution(0), std::invalid_argument);
  EXPECT_THROW(LeafAngleDistribution(NAN), std::invalid_argument);
}

// Whatever the leaf angles, the projected area averaged over all directions is half of the leaf
// area (Cauchy).
TEST(LeafAngleDistribution, ProjectionAveragesToOneHalfOverTheSphere) {
  for (const double shape : {0.05, 0.5, 3.0, 30.0}) {
    double mean = 0;
    for (int i = 0; i < 4000; ++i)
      mean += LeafAngleDistribution(shape).projection((i + 0.5) / 4000) / 4000;
    EXPECT_NEAR(mean, 0.5, 1e-4) << shape;
  }
}

TEST(LinkBudget, PowerFollowsTheLidarEquation) {
  const LinkBudget link;
  const double p = received_power_w(link, 20, 0.5, 1, 0);
  EXPECT_NEAR(p, 25 * 0.5 * 0.025 * 0.025 / (4 * 400) * 0.5, 1e-15);
  EXPECT_NEAR(received_power_w(link, 40, 0.5, 1, 0), p / 4, 1e-15);
  EXPECT_NEAR(received_power_w(link, 20, 0.25, 1, 0), p / 2, 1e-15);
  EXPECT_NEAR(received_power_w(link, 20, 0.5, 0.1, 0), p / 10, 1e-15);
  EXPECT_NEAR(received_power_w(link, 20, 0.5, 1, 0.01), p * std::exp(-0.4), 1e-15);
  EXPECT_NEAR(signal_at_1m(link) * noise_power_w(link, 0), received_power_w(link, 1, 1, 1, 0),
              1e-12);
}

TEST(LinkBudget, SunlightRaisesTheNoiseAsItsShotNoiseDoes) {
  // The irradiance over all wavelengths is the solar constant.
  double total = 0;
  for (double l = 100e-9; l < 30e-6; l += 2e-9) total += solar_irradiance(l) * 2e-9;
  EXPECT_NEAR(total, 1361, 15);
  const LinkBudget link;
  const double sun = solar_background_w(link, 0.5, 0.75);
  EXPECT_GT(sun, 1e-10);
  EXPECT_LT(sun, 1e-7);
  EXPECT_DOUBLE_EQ(noise_in_light(link, 0), 1);
  EXPECT_GT(noise_in_light(link, sun), 1);
  // In strong light the noise grows with the square root.
  EXPECT_NEAR(noise_in_light(link, 4.0) / noise_in_light(link, 1.0), 2, 1e-3);
}

TEST(Air, ExtinctionFallsWithVisibilityAndGrowsWithRain) {
  // At 550 nm, visibility is defined by a remaining contrast of 2 %.
  EXPECT_NEAR(std::exp(-fog_extinction_per_m(2000, 550e-9) * 2000), 0.02, 1e-4);
  EXPECT_NEAR(fog_extinction_per_m(400, 905e-9), 3.912 / 400, 1e-12);
  EXPECT_NEAR(fog_extinction_per_m(10e3, 905e-9), 3.912e-4 * std::pow(905.0 / 550, -1.3), 1e-12);
  double before = INFINITY;
  for (double v = 50; v < 1e5; v *= 1.1) {
    EXPECT_LT(fog_extinction_per_m(v, 905e-9), before);
    before = fog_extinction_per_m(v, 905e-9);
  }
  EXPECT_EQ(rain_extinction_per_m(0), 0);
  EXPECT_NEAR(rain_extinction_per_m(1) * 1000 * 10 / M_LN10, 1.076, 1e-12);  // dB/km
}

TEST(Materials, EveryClassIsMadeOfOneAndReflectsSome) {
  const Materials all = load_materials();
  EXPECT_FALSE(all.sources.empty());
  for (const std::string_view name : elements::kClassNames) {
    for (const double nm : {400.0, 850.0, 905.0, 1550.0, 3000.0}) {
      const double r = all.of(name).reflectance_at(nm * 1e-9);
      EXPECT_GT(r, 0) << name;
      EXPECT_LT(r, 1) << name;
    }
  }
  EXPECT_EQ(&all.of("ground"), &all.named("soil"));
  EXPECT_EQ(&all.of("no such class"), &all.of("unknown"));
  EXPECT_NEAR(all.named("leaf").reflectance_at(877.5e-9), 0.475, 1e-12);  // half-way
  try {
    (void)all.named("asphlat");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("'asphalt'"), std::string::npos);
  }
}

TEST(Materials, ErrorsNameFileAndPlace) {
  const io::TemporaryFolder folder;
  const std::string path = (folder / "materials.yaml").string();
  const std::string good =
      "wavelength_nm: [900, 1000]\nmaterials:\n  mud: {reflectance: [0.1, 0.2]}\n"
      "classes: {unknown: mud}\n";
  const auto error = [&](const std::string& from, const std::string& to) -> std::string {
    std::string text = good;
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    std::ofstream(path) << text;
    try {
      load_materials(path);
    } catch (const FormatError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(error("", ""), "");
  const std::pair<std::string, std::string> bad[] = {{"[0.1, 0.2]", "[0.1]"},
                                                     {"[0.1, 0.2]", "[0.1, 1.2]"},
                                                     {"[0.1, 0.2]", "[0.1, .nan]"},
                                                     {"reflectance", "reflection"},
                                                     {"[900, 1000]", "[900, 900]"},
                                                     {"unknown: mud", "unknown: mut"},
                                                     {"[0.1, 0.2]}", "[0.1, 0.2], brdf: shiny}"},
                                                     {"classes", "class"},
                                                     {"{unknown: mud}", "mud"},
                                                     {"[900", "[[900"}};
  for (const auto& [from, to] : bad) {
    EXPECT_NE(error(from, to).find(path), std::string::npos) << to;
  }
  EXPECT_NE(error("unknown: mud", "ground: mud").find("'unknown' is missing"), std::string::npos);
  EXPECT_THROW(load_materials("/no/such/file.yaml"), FormatError);
}

}  // namespace
}  // namespace underbrush::radiometry
