#include "underbrush/sensor/sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "io/temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::sensor {
namespace {

TEST(Catalogue, EveryNameLoadsAndSaysWhereItsValuesComeFrom) {
  const std::vector<std::string> all = names();
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  for (const char* name : {"velodyne-vlp16", "velodyne-vlp32c", "velodyne-hdl32e",
                           "velodyne-hdl64e", "ouster-os1-64", "ibeo-lux-2010", "optech-ilris-3d",
                           "generic-spinning", "generic-raster", "generic-directions"}) {
    EXPECT_TRUE(std::count(all.begin(), all.end(), name)) << name;
  }
  for (const std::string& name : all) {
    const Sensor s = load(name);
    EXPECT_EQ(s.name, name);
    EXPECT_FALSE(s.sources.empty()) << name;
    EXPECT_NO_THROW(s.check()) << name;
    EXPECT_GT(s.beam.exit_diameter_m, 0) << name;
    EXPECT_GT(s.beam.divergence_rad[1], 0) << name;
    EXPECT_GT(s.wavelength_m, 800e-9) << name;
    EXPECT_GT(s.range_sigma_m, 0) << name;
    EXPECT_GT(s.signal.detection_range_m, 0) << name;
    // Ring numbers run from one end of the field of view to the other.
    for (size_t i = 2; i < s.channels.size(); ++i) {
      EXPECT_GT((s.channels[i].elevation_rad - s.channels[i - 1].elevation_rad) *
                    (s.channels[1].elevation_rad - s.channels[0].elevation_rad),
                0)
          << name << " ring " << i;
    }
  }
}

// The makers' beam rates, azimuth steps and packet sizes follow from the timing tables.
TEST(Catalogue, RatesAgreeWithTheMakersFigures) {
  const Sensor vlp16 = load("velodyne-vlp16"), hdl32 = load("velodyne-hdl32e");
  const Sensor hdl64 = load("velodyne-hdl64e"), os1 = load("ouster-os1-64");
  EXPECT_NEAR(vlp16.beams_per_s(), 289351, 1);
  EXPECT_NEAR(hdl32.beams_per_s(), 694444, 1);
  EXPECT_NEAR(hdl64.beams_per_s(), 1.3333e6, 1e2);
  EXPECT_NEAR(os1.beams_per_s(), 1310720.0 / 2, 1);  // the maker states the 20 Hz mode
  EXPECT_NEAR(load("ouster-os1-128").beams_per_s(), 1310720, 1);
  EXPECT_NEAR(load("ouster-os2-128").beams_per_s(), 2621440, 1);
  EXPECT_NEAR(load("velodyne-vls128").beams_per_s(), 2401498, 20);
  EXPECT_NEAR(load("hesai-pandar64").beams_per_s(), 1152000, 1);
  EXPECT_NEAR(load("hesai-xt32").beams_per_s(), 640000, 1);
  EXPECT_NEAR(vlp16.azimuth_step_rad() / kDegree, 0.199, 1e-3);
  EXPECT_NEAR(hdl32.azimuth_step_rad() / kDegree, 0.1659, 1e-4);
  EXPECT_NEAR(os1.firings_per_revolution(), 1024, 1e-6);
  for (const Sensor& s : {vlp16, hdl32, hdl64, load("velodyne-vlp32c")}) {
    EXPECT_EQ(s.beams_per_packet(), 384u) << s.name;
  }
}

TEST(Catalogue, FiringOrderIsTheMakers) {
  const Sensor s = load("velodyne-hdl32e");
  const std::vector<uint16_t> order = s.firing_order();
  const double first[] = {-30.67, -9.33, -29.33, -8.00, -28.00, -6.66};
  for (size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(s.channels[order[k]].elevation_rad / kDegree, first[k], 1e-9);
    EXPECT_NEAR(s.channels[order[k]].time_s, double(k) * 1.152e-6, 1e-15);
  }
}

class SensorFile : public testing::Test {
 protected:
  // Loads a copy of the generic sensor's file with `from` replaced by `to`, and gives the message
  // of the error.
  std::string error_with(const std::string& from, const std::string& to) {
    std::string text =
        "name: mine\nkind: spinning\nrotation: clockwise\nrate_hz: 10\nfiring_period_us: 50\n"
        "min_range_m: 1\nmax_range_m: 50\nchannels:\n  elevation_deg: [1, 2]\n  time_us: [0, 5]\n";
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    std::ofstream(path_) << text;
    try {
      sensor_ = load(path_);
    } catch (const FormatError& e) {
      return e.what();
    }
    return "";
  }

  io::TemporaryFolder folder_;
  std::string path_ = (folder_ / "mine.yaml").string();
  Sensor sensor_;
};

TEST_F(SensorFile, OwnFileLoads) {
  EXPECT_EQ(error_with("", ""), "");
  EXPECT_EQ(sensor_.name, "mine");
  EXPECT_NEAR(sensor_.channels[1].time_s, 5e-6, 1e-18);
}

TEST_F(SensorFile, EvenlySpacedElevations) {
  EXPECT_EQ(error_with("elevation_deg: [1, 2]\n  time_us: [0, 5]",
                       "elevation_deg: {first: 5, last: -3, count: 5}"),
            "");
  ASSERT_EQ(sensor_.channels.size(), 5u);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(sensor_.channels[i].elevation_rad / kDegree, 5 - 2.0 * double(i), 1e-12);
  }
}

TEST_F(SensorFile, SizesInOtherUnitsAreRefused) {
  for (const auto& [from, to, reason] : std::vector<std::array<const char*, 3>>{
           {"rate_hz: 10", "rate_hz: 600", "in revolutions a minute?"},
           {"rate_hz: 10", "rate_hz: 10\nrate_hz: 20", "rate_hz: twice"},
           {"max_range_m: 50", "max_range_m: 120000", "is it in mm?"},
           {"max_range_m: 50", "max_range_m: 50\nrange_sigma_m: 20", "is it in mm?"},
           {"max_range_m: 50", "max_range_m: 50\nwavelength_nm: 0.905", "100 nm to 20 µm"},
           {"[1, 2]\n  time_us: [0, 5]", "{first: -0.26, last: 0.26, count: 16}", "in radians?"}}) {
    EXPECT_NE(error_with(from, to).find(reason), std::string::npos) << to;
  }
}

TEST_F(SensorFile, ErrorsNameFileAndPlace) {
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    const std::string error = error_with(from, to);
    EXPECT_NE(error.find(path_), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << to << " gave: " << error;
  };
  expect("rate_hz: 10", "rate_hz: fast", "rate_hz");
  expect("rate_hz: 10", "rate_hz: -1", "rate");
  expect("rate_hz: 10", "rate_hz: 1e-300", "a turn has 1 to 1 000 000 firings");
  expect("rate_hz: 10\n", "", "rate_hz: missing");
  expect("rate_hz", "rate_khz", "rate_khz: unknown key");
  expect("time_us: [0, 5]", "time_us: [0]", "channels.time_us");
  expect("time_us: [0, 5]", "time_us: [0, 99]", "firing period");
  expect("time_us: [0, 5]", "z_mm: [0, 20000]", "channels.z_mm: must be within ±10000");
  expect("time_us: [0, 5]", "azimuth_deg: [0, 1e308]", "channels.azimuth_deg: must be within ±360");
  expect("elevation_deg: [1, 2]", "elevation_deg: [1, .nan]", "elevation");
  expect("[1, 2]", "{first: 1, last: 2}", "count: missing");
  expect("[1, 2]", "{first: 1, last: 2, count: 1}", "count");
  expect("[1, 2]", "{first: 1, last: 2, count: -1}", "count");
  expect("spinning", "gear", "kind: must be one of spinning");
  expect("spinning", "raster", "raster: missing");
  expect("spinning", "sweep", "azimuth_from_deg: missing");
  expect("spinning", "directions", "cycle_s: missing");
  expect("min_range_m: 1", "min_range_m: 1\nreceiver: {pulse: square}", "receiver.pulse");
  expect("min_range_m: 1", "min_range_m: 1\nreceiver: {pulse_ns: -3}", "pulse");
  for (const char* time :
       {"sample_ns: 1e300", "sample_ns: 1e-300", "pulse_ns: 1e-300", "pulse_ns: .nan",
        "response_ns: 20000", "pulse_ns: 18446744073709551615"}) {
    expect("min_range_m: 1", std::string("min_range_m: 1\nreceiver: {") + time + "}",
           "0.001 to 10000 ns");
  }
  for (const char* pulse : {"pulse_ns: 501", "response_ns: 501"}) {
    expect("min_range_m: 1", std::string("min_range_m: 1\nreceiver: {sample_ns: 1, ") + pulse + "}",
           "longer than 500 samples");
  }
  expect("min_range_m: 1", "min_range_m: 1\nreceiver: {echo: 3}", "receiver.echo: unknown key");
  const std::pair<const char*, const char*> beyond_float[] = {
      {"threshold_snr: 1e-300", "threshold"},
      {"saturation_snr: 1e300", "threshold"},
      {"min_gap_m: 1e300", "negative or huge length"},
      {"adc_step_snr: 1e300", "step of the converter"},
      {"intensity_scale: 1e-300", "intensity scale"},
      {"detects: {range_m: 30, reflectance: 1e300}", "detection range or reflectance"}};
  for (const auto& [line, part] : beyond_float) {
    expect("min_range_m: 1", std::string("min_range_m: 1\nreceiver: {") + line + "}", part);
  }
  for (const char* lines : {"[0, 9]", "[9, 1e300]", "[9, -1]", "[1025, 9]", "[9, .nan]"}) {
    expect("min_range_m: 1", std::string("min_range_m: 1\nsub_rays: ") + lines,
           "sub_rays: must be 1 to 1024");
  }
  expect("min_range_m: 1", "min_range_m: 1\ndivergence_mrad: 3", "divergence_mrad");
  expect("min_range_m: 1", "min_range_m: 1\nprofile: table", "profile_table");
  expect("min_range_m: 1", "min_range_m: 1\nprofile: table\nprofile_table: [[1, 2], [3]]",
         "profile_table: rows differ");
  expect("  time_us", "  azimuth_to_deg: [1, 2]\n  time_us", "only for a sweep");
  expect("clockwise", "left", "rotation");
  expect("name: mine", "name: [mine", "line");
  expect("channels:\n  elevation_deg: [1, 2]\n  time_us: [0, 5]\n", "channels: 4\n", "channels");
}

TEST(Shots, FromATableOfDirections) {
  const auto plain = shots_from_csv("a.csv", "azimuth_deg,elevation_deg\n# c\n90,0\r\n-90,45\n", 2);
  ASSERT_EQ(plain.size(), 2u);
  EXPECT_NEAR(plain[0].azimuth_rad, M_PI / 2, 1e-12);
  EXPECT_NEAR(plain[1].elevation_rad, M_PI / 4, 1e-12);
  EXPECT_EQ(plain[1].time_s, 1);
  const auto full = shots_from_csv("a.csv", "1 2 0 7\n3 4 500000 8", 2);
  EXPECT_EQ(full[1].ring, 8);
  EXPECT_NEAR(full[1].time_s, 0.5, 1e-12);
  for (const char* bad : {"", "head\n", "1,2\n3\n", "1,2\n3,x\n", "1,95\n", "1,2,5\n3,4,4\n",
                          "1,2,9e9\n", "1,2,0,-1\n", "1,nan\n", "1,2,3,4,5\n", "a\nb\n1,2\n"}) {
    EXPECT_THROW(shots_from_csv("a.csv", bad, 2), FormatError) << bad;
  }
}

TEST(Catalogue, OwnTableOfDirectionsLiesBesideItsFile) {
  const io::TemporaryFolder folder;
  const std::string yaml = (folder / "mine.yaml").string();
  const auto write = [&](const std::string& rate_hz) {
    std::ofstream(yaml) << "name: mine\nkind: directions\nrate_hz: " + rate_hz +
                               "\ncycle_s: 0.5\ndirections: mine.csv\nmin_range_m: 1\n"
                               "max_range_m: 50\n";
  };
  const auto refusal = [&]() -> std::string {
    try {
      load(yaml);
    } catch (const FormatError& e) {
      EXPECT_EQ(e.file(), yaml);
      return e.place() + ": " + e.reason();
    }
    return "accepted";
  };
  write("10");
  EXPECT_EQ(refusal(), "directions: " + (folder / "mine.csv").string() + ": no such file");
  std::ofstream(folder / "mine.csv") << "1,2\n3,4\n5,6\n";
  const Sensor s = load(yaml);
  EXPECT_EQ(s.shots.size(), 3u);
  EXPECT_NEAR(s.beams_per_s(), 6, 1e-9);
  write("1e-300");
  EXPECT_EQ(refusal(), "rate_hz: a frame has at most 100 000 000 shots");
}

TEST(Catalogue, UnknownNameSaysWhatIsKnown) {
  try {
    load("velodyne-vlp61");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("did you mean 'velodyne-vlp16'"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("velodyne-vlp16"), std::string::npos);
  }
}

}  // namespace
}  // namespace underbrush::sensor
