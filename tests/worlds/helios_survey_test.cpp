#include <cmath>

#include "sensor/wedge_oracle.hpp"
#include "worlds/helios_files.hpp"

namespace underbrush::worlds {
namespace {

const std::string kTurn =
    "<leg><platformSettings x=\"3\" y=\"4\" z=\"1\" onGround=\"false\"/><scannerSettings "
    "template=\"t\" headRotatePerSec_deg=\"36\" headRotateStart_deg=\"10\" "
    "headRotateStop_deg=\"190\"/></leg>";

// A pulse of a rotating mirror at time t has the elevation of the mirror and the azimuth of the
// head at that time, in the frame of HELIOS++: y forward, angles counter-clockwise.
TEST_F(HeliosSurvey, ATripodTurnsItsHead) {
  const Survey s =
      read_helios_survey(survey("platform=\"platforms.xml#tripod\"", kTurn, "rotating"), {});
  ASSERT_EQ(s.legs.size(), 1u);
  const BeamLog beams = beams_of(s.legs[0]);
  EXPECT_NEAR(sensor_.wavelength_m, 1550e-9, 1e-15);
  EXPECT_EQ(sensor_.max_range_m, 250);
  EXPECT_NEAR(sensor_.beam.divergence_rad[0], 0.001 * 0.58871, 1e-7);
  ASSERT_GT(beams.size(), 3000u);
  const double step = 2 * 60 * 10 / 1000.0;
  for (size_t k = 0; k < beams.size(); k += 7) {
    const Vec3 d = beams.direction[k].cast<double>();
    EXPECT_LT((beams.origin[k] - Vec3(3, 4, 2.7)).norm(), 1e-9);
    const double t = beams.time_s[k], head = 10 + 36 * (t + 1e-3);
    const double elevation = std::asin(d.z()) * 180 / M_PI;
    const auto pulse = size_t(std::lround(t * 1000)) % 100;
    EXPECT_NEAR(elevation, -60 + step * double(pulse), 1e-3) << t;
    EXPECT_LE(std::abs(elevation), 45 + 1e-3);
    const Vec3 expected =
        Eigen::AngleAxisd(head * M_PI / 180, Vec3::UnitZ()) *
        Vec3(0, std::cos(elevation * M_PI / 180), std::sin(elevation * M_PI / 180));
    EXPECT_LT((d - expected).norm(), 1e-4) << t;
  }
}

// The head of the scanner turns at most at 40 degrees a second.
TEST_F(HeliosSurvey, AHeadIsNoFasterThanItsScanner) {
  const std::string tripod = "platform=\"platforms.xml#tripod\"";
  const auto duration_of = [&](const std::string& speed) {
    const std::string leg =
        "<leg><platformSettings/><scannerSettings template=\"t\" "
        "headRotateStop_deg=\"80\" headRotatePerSec_deg=\"" +
        speed + "\"/></leg>";
    const Survey s = read_helios_survey(survey(tripod, leg, "rotating"), {});
    EXPECT_EQ(s.left_out.count("speeds of the head above headRotatePerSecMax_deg"),
              speed == "400" ? 1u : 0u);
    const auto& poses = s.legs.at(0).trajectory.poses();
    return poses.back().time_s - poses.front().time_s;
  };
  EXPECT_NEAR(duration_of("20"), 4, 1e-9);
  EXPECT_NEAR(duration_of("40"), 2, 1e-9);
  EXPECT_NEAR(duration_of("400"), 2, 1e-9);
}

// HELIOS++ does not turn such a head at all; here it turns as the leg says.
TEST_F(HeliosSurvey, AHeadOfAScannerThatStatesNoLimitTurnsAsTheLegSays) {
  const fs::path file = survey("platform=\"platforms.xml#tripod\"", kTurn, "rotating");
  std::ifstream in(folder / "scanners.xml");
  std::string scanner{std::istreambuf_iterator<char>(in), {}};
  const std::string limit = "headRotatePerSecMax_deg=\"40\" ";
  scanner.erase(scanner.find(limit), limit.size());
  write("scanners.xml", scanner);
  const Survey s = read_helios_survey(file, {});
  const auto& poses = s.legs.at(0).trajectory.poses();
  EXPECT_NEAR(poses.back().time_s - poses.front().time_s, 180.0 / 36, 1e-9);
  EXPECT_TRUE(s.left_out.empty());
}

TEST_F(HeliosSurvey, APlaneFliesFromLegToLeg) {
  const std::string legs =
      "<leg><platformSettings x=\"0\" y=\"0\" z=\"100\" movePerSec_m=\"20\"/><scannerSettings "
      "template=\"t\"/></leg>"
      "<leg><platformSettings x=\"40\" y=\"0\" z=\"100\" movePerSec_m=\"10\"/><scannerSettings "
      "template=\"t\" "
      "active=\"false\"/></leg>"
      "<leg><platformSettings x=\"40\" y=\"30\" z=\"100\"/><scannerSettings template=\"t\"/></leg>";
  const Survey s =
      read_helios_survey(survey("platform=\"platforms.xml#plane\"", legs, "oscillating"), {});
  ASSERT_EQ(s.legs.size(), 1u);
  EXPECT_EQ(s.left_out.at("legs with an inactive scanner"), 1u);
  EXPECT_EQ(s.left_out.at("legs without a duration"), 1u);
  const auto& poses = s.legs[0].trajectory.poses();
  EXPECT_DOUBLE_EQ(poses.back().time_s - poses.front().time_s, 2);
  EXPECT_LT((poses.back().world_from_sensor.translation - Vec3(40, 0, 100.9)).norm(), 1e-9);
  const BeamLog beams = beams_of(s.legs[0]);
  double widest = 0;
  for (size_t k = 0; k < beams.size(); ++k) {
    const Vec3 d = beams.direction[k].cast<double>();
    // The mount looks down, and the mirror swings across the way, which is along x.
    EXPECT_NEAR(d.x(), 0, 1e-6);
    EXPECT_LT(d.z(), 0);
    widest = std::max(widest, std::abs(std::atan2(d.y(), -d.z())));
  }
  EXPECT_NEAR(widest, M_PI / 4, 1e-3);
}

TEST_F(HeliosSurvey, ATrajectoryHasSevenColumns) {
  write("path.trj",
        "#TIME_COLUMN: 0\n10,0,0,90,1,2,3\n11,0,0,90,5,2,3\n12,0,0,90,9,2,3\n13,0,0,90,13,2,3\n");
  const std::string leg =
      "<leg><platformSettings trajectory=\"path.trj\" tStart=\"10.5\" tEnd=\"12.5\"/>"
      "<scannerSettings template=\"t\"/></leg>";
  const Survey s =
      read_helios_survey(survey("platform=\"interpolated\"", leg, "line", "numFibers=\"5\""), {});
  const auto& poses = s.legs.at(0).trajectory.poses();
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].time_s, 11);
  EXPECT_LT((poses[0].world_from_sensor.translation - Vec3(5, 2, 3.2)).norm(), 1e-9);
  const BeamLog beams = beams_of(s.legs[0]);
  // Yaw of 90 degrees to the right by ARINC 705: forward is along x.
  EXPECT_GT(beams.direction[2].x(), 0.7);
  EXPECT_EQ(sensor_.shots.size(), 5u);
  EXPECT_EQ(beams.ring[3], 3);
  for (const char* rows :
       {"", "1,2,3\n", "1,0,0,0,1,2,3\n1,0,0,0,1,2,3\n", "1,0,0,nan,1,2,3\n2,0,0,0,0,0,0\n"}) {
    write("path.trj", rows);
    EXPECT_THROW(read_helios_survey(folder / "survey.xml", {}), FormatError) << rows;
  }
}

TEST_F(HeliosSurvey, LegsStandOnTheGroundAndPlatformsAreSaid) {
  const std::string leg =
      "<leg><platformSettings x=\"1\" y=\"1\" z=\"9\" onGround=\"true\"/><scannerSettings "
      "template=\"t\" maxDuration_s=\"2\" headRotatePerSec_deg=\"0\"/><FWFSettings/></leg>";
  const Survey s = read_helios_survey(survey("platform=\"platforms.xml#tripod\"", leg, "conic"),
                                      [](double, double) { return std::optional<double>(4); });
  EXPECT_NEAR(s.legs.at(0).trajectory.poses().at(0).world_from_sensor.translation.z(),
              4 + 1.5 + 0.2, 1e-12);
  EXPECT_EQ(s.left_out.at("elements FWFSettings in leg"), 1u);
  const BeamLog beams = beams_of(s.legs[0]);
  for (size_t k = 0; k < beams.size(); k += 11) {
    EXPECT_NEAR(beams.direction[k].y(), std::cos(M_PI / 4), 1e-6);  // on a cone about forward
  }
  const std::string way =
      "<leg><platformSettings x=\"0\"/><scannerSettings template=\"t\"/></leg>"
      "<leg><platformSettings x=\"9\"/></leg>";
  const Survey c =
      read_helios_survey(survey("platform=\"platforms.xml#copter\"", way, "conic"), {});
  EXPECT_EQ(c.left_out.at("dynamics of the platform multicopter"), 2u);
}

const std::string kPrisms =
    "rotorFreq1_Hz=\"-121.5\" rotorFreq2_Hz=\"77.7\" angle1_deg=\"18.7\" angle2_deg=\"-17.9\" "
    "refrIndex1=\"1.51\" refrIndex2=\"1.6\"";
const std::vector<sensor::Wedge> kWedges{{-121.5, 18.7, 1.51}, {77.7, -17.9, 1.6}};

std::string stand(const std::string& scanner_settings) {
  return "<leg><platformSettings x=\"3\" y=\"4\" z=\"1\"/><scannerSettings template=\"t\" "
         "maxDuration_s=\"0.5\" " +
         scanner_settings + "/></leg>";
}

// HELIOS++ turns the prisms before the first pulse, and goes on from leg to leg while the scanner
// is active.
TEST_F(HeliosSurvey, PrismsTurnFromLegToLeg) {
  const std::string legs =
      stand("") + stand("active=\"false\"") + stand("opticsWarmupPhase_s=\"0.02\"");
  const Survey s =
      read_helios_survey(survey("platform=\"platforms.xml#tripod\"", legs, "risley", kPrisms), {});
  ASSERT_EQ(s.legs.size(), 2u);
  for (const size_t leg : {0u, 1u}) {
    EXPECT_TRUE(s.legs[leg].table_name.empty());
    const BeamLog beams = beams_of(s.legs[leg]);
    ASSERT_EQ(beams.size(), 500u);
    EXPECT_NEAR(sensor_.wavelength_m, 1550e-9, 1e-15);
    for (size_t k = 0; k < beams.size(); ++k) {
      const double turned_s = double(k + 1) / 1000 + (leg == 1 ? 0.52 : 0);
      const Vec3 expected = sensor::behind_wedges(kWedges, turned_s, Vec3::UnitY());
      ASSERT_LT((beams.direction[k].cast<double>() - expected).norm(), 1e-6) << k;
      ASSERT_LT((beams.origin[k] - Vec3(3, 4, 2.7)).norm(), 1e-9);
    }
  }
}

TEST_F(HeliosSurvey, ChannelsWithPrismsFlyOnAPlatform) {
  const std::string channels =
      "<channels><channel><incidentBeam x=\"-0.1\" y=\"2\"/></channel>"
      "<channel rotorFreq2_Hz=\"10\" refrIndex_air=\"1.1\"><beamOrigin><rot axis=\"z\" "
      "angle_deg=\"-30\"/></beamOrigin></channel><channel optics=\"conic\"/></channels>";
  const std::string legs =
      "<leg><platformSettings z=\"100\" movePerSec_m=\"20\"/><scannerSettings template=\"t\"/>"
      "</leg><leg><platformSettings x=\"40\" z=\"100\"/></leg>";
  const Survey s = read_helios_survey(
      survey("platform=\"platforms.xml#plane\"", legs, "risley", kPrisms, channels), {});
  EXPECT_EQ(s.left_out.at("channels with other optics than their scanner"), 1u);
  const BeamLog beams = beams_of(s.legs.at(0));
  ASSERT_EQ(beams.size(), 4000u);
  const auto about = [](const Vec3& axis, double degrees) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180, axis));
  };
  // The mount turns about x, then about z; the platform's forward is along x.
  const Eigen::Quaterniond world_from_head =
      about(Vec3::UnitZ(), -90) * about(Vec3::UnitZ(), 90) * about(Vec3::UnitX(), -90);
  const std::vector<sensor::Wedge> own{{-121.5, 18.7, 1.51 / 1.1}, {10, -17.9, 1.6 / 1.1}};
  const Vec3 tilted = Vec3(-0.1, 2, 0).normalized();
  for (size_t i = 0; i < beams.size(); i += 17) {
    const double turned_s = double(i / 2 + 1) / 1000;
    Vec3 expected = sensor::behind_wedges(kWedges, turned_s, tilted);
    if (i % 2 == 1) {
      expected = about(Vec3::UnitZ(), -30) * sensor::behind_wedges(own, turned_s, Vec3::UnitY());
    }
    ASSERT_LT((beams.direction[i].cast<double>() - world_from_head * expected).norm(), 1e-6) << i;
    ASSERT_EQ(beams.ring[i], i % 2);
  }
}

// Law: beams after a warm-up are those of a scanner without one from that time on.
TEST_F(HeliosSurvey, AWarmUpTurnsHeadAndOptics) {
  for (const std::string optics : {"oscillating", "rotating", "conic", "risley"}) {
    std::map<long, Vec3f> pulses[2];
    for (const size_t warm : {0u, 1u}) {
      const std::string leg =
          stand("headRotatePerSec_deg=\"36\" headRotateStop_deg=\"190\" opticsWarmupPhase_s=\"" +
                std::string(warm == 1 ? "0.137" : "0") + "\"");
      const Survey s =
          read_helios_survey(survey("platform=\"platforms.xml#tripod\"", leg, optics, kPrisms), {});
      const BeamLog beams = beams_of(s.legs.at(0));
      for (size_t k = 0; k < beams.size(); ++k) {
        pulses[warm][std::lround(beams.time_s[k] * 1000) + 137 * long(warm)] = beams.direction[k];
      }
    }
    size_t both = 0;
    for (const auto& [pulse, direction] : pulses[1]) {
      const auto same = pulses[0].find(pulse);
      if (same == pulses[0].end()) continue;
      ASSERT_LT((same->second - direction).norm(), 2e-6) << optics << pulse;
      ++both;
    }
    EXPECT_GT(both, 200u) << optics;
  }
}

TEST_F(HeliosSurvey, ASensorThatNoSimulationTakesIsNotWritten) {
  const std::string tripod = "platform=\"platforms.xml#tripod\"", leg = stand("");
  const auto written = [&](const std::string& optics, const std::string& scanner) -> std::string {
    const fs::path file = survey(tripod, leg, optics, scanner);
    const World world = read_helios_scene(file);
    try {
      write_survey(folder / "out", world, read_helios_survey(file, {}), "{}");
    } catch (const FormatError& e) {
      EXPECT_FALSE(fs::exists(folder / "out"));
      EXPECT_EQ(e.file(), file.string());
      EXPECT_EQ(e.place(), "leg 0");
      return e.reason();
    }
    fs::remove_all(folder / "out");
    return "";
  };
  EXPECT_EQ(written("risley", kPrisms), "");
  EXPECT_EQ(written("conic", ""), "");
  // Beyond the critical angle of 30°.
  EXPECT_EQ(written("risley", "angle1_deg=\"-40\" refrIndex1=\"2\" rotorFreq1_Hz=\"10\""),
            "sensor: a prism reflects a beam totally");
  EXPECT_EQ(written("risley", "angle1_deg=\"95\" refrIndex1=\"1.1\" rotorFreq1_Hz=\"10\""),
            "sensor: a prism's angle is below 90 degrees");
}

TEST_F(HeliosSurvey, RefusesWhatIsWrong) {
  const std::string tripod = "platform=\"platforms.xml#tripod\"";
  EXPECT_THROW(read_helios_survey(survey(tripod, kTurn, "kaleidoscope"), {}), FormatError);
  for (const char* prisms :
       {"", "rotorFreq1_Hz=\"7294\" rotorFreq2_Hz=\"-4664\"", "angle1_deg=\"x\"",
        "angle1_deg=\"9\" refrIndex1=\"0\"", "angle1_deg=\"9\" refrIndex_air=\"0\""}) {
    EXPECT_THROW(read_helios_survey(survey(tripod, kTurn, "risley", prisms), {}), FormatError)
        << prisms;
  }
  EXPECT_THROW(read_helios_survey(survey(tripod, kTurn, "risley", kPrisms,
                                         "<channels><channel optics=\"line\"/></channels>"),
                                  {}),
               FormatError);
  EXPECT_THROW(read_helios_survey(survey("platform=\"platforms.xml#none\"", kTurn, "conic"), {}),
               FormatError);
  EXPECT_THROW(
      read_helios_survey(survey("platform=\"../platforms.xml#tripod\"", kTurn, "conic"), {}),
      FormatError);
  EXPECT_THROW(read_helios_survey(survey("platform=\"platforms.xml#tripod\"", "", "conic"), {}),
               FormatError);
  for (const char* settings :
       {"pulseFreq_hz=\"0\" scanFreq_hz=\"10\"", "pulseFreq_hz=\"1e300\" scanFreq_hz=\"10\"",
        "pulseFreq_hz=\"100\" scanFreq_hz=\"-1\"", "pulseFreq_hz=\"100\" scanFreq_hz=\"1e-9\"",
        "active=\"maybe\"", "template=\"none\"", "pulseFreq_hz=\"x\""}) {
    const std::string leg =
        "<leg><platformSettings/><scannerSettings headRotatePerSec_deg=\"10\" "
        "headRotateStop_deg=\"90\" " +
        std::string(settings) + "/></leg>";
    EXPECT_THROW(read_helios_survey(survey("platform=\"platforms.xml#tripod\"", leg, "conic"), {}),
                 FormatError)
        << settings;
  }
}

}  // namespace
}  // namespace underbrush::worlds
