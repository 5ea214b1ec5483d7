// Tests of the report's pictures: colours mean what the legend says, and every beam is in its
// place.
#include <gtest/gtest.h>

#include <cmath>

#include "io/temporary.hpp"
#include "report/survey.hpp"
#include "underbrush/io/log_file.hpp"

namespace underbrush::report {
namespace {

Rgb at(const io::Image& image, int x, int y) {
  const size_t k = 3 * (size_t(y) * size_t(image.width) + size_t(x));
  return {image.rgb[k], image.rgb[k + 1], image.rgb[k + 2]};
}

TEST(Base64, Rfc4648) {
  const char* expected[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (size_t n = 0; n <= 6; ++n) EXPECT_EQ(base64("foobar", n), expected[n]);
}

TEST(Colours, ErrorsAreSymmetricAboutGreyAndClamped) {
  EXPECT_EQ(error_colour(-5), error_colour(-kErrorScale));
  EXPECT_EQ(error_colour(5), error_colour(kErrorScale));
  const Rgb near = error_colour(-1), far = error_colour(1), none = error_colour(0);
  EXPECT_GT(near[2], near[0]);  // blue
  EXPECT_GT(far[0], far[2]);    // red
  EXPECT_LT(std::abs(int(none[0]) - int(none[2])), 20);
  EXPECT_EQ(scale_colour(-1), scale_colour(0));
  EXPECT_EQ(scale_colour(2), scale_colour(1));
}

TEST(TopPicture, TheHighestIsSeenInAnyOrder) {
  const TopView view{Vec3(10, 20, 0), 0.5, 8, 4};  // x 10 … 14, y 20 … 18
  const Rgb low{1, 2, 3}, high{200, 100, 50};
  for (const bool low_first : {true, false}) {
    TopPicture picture(view);
    picture.add({11.2, 19.2, low_first ? 1.0 : 3.0}, low_first ? low : high);
    picture.add({11.3, 19.1, low_first ? 3.0 : 1.0}, low_first ? high : low);
    picture.add({9.9, 19, 9}, low);  // outside
    picture.add({NAN, 19, 9}, low);
    const io::Image image = picture.image();
    EXPECT_EQ(at(image, 2, 1), high);
    EXPECT_EQ(at(image, 0, 1), kBackground);
    EXPECT_EQ(at(picture.closed().image(), 1, 1), kBackground) << "one point closes no gap";
  }
}

TEST(TopPicture, GapsBetweenPointsAreClosed) {
  TopPicture picture({Vec3(0, 3, 0), 1, 3, 3});
  picture.add({0.5, 1.5, 1}, {10, 10, 10});
  picture.add({2.5, 1.5, 2}, {20, 20, 20});
  EXPECT_EQ(at(picture.closed().image(), 1, 1), (Rgb{20, 20, 20}));
}

// Makes a scan of four rings and four azimuths. Beam (ring, column) points left of ahead by
// π/2·(1.5 − column).
std::vector<ScanBeam> small_scan() {
  std::vector<ScanBeam> scan;
  for (uint16_t ring = 0; ring < 4; ++ring) {
    for (int column = 0; column < 64; ++column) {
      const double azimuth = 3 - column * 6.0 / 63, elevation = 0.1 * ring;
      const Vec3 d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                   std::sin(elevation));
      scan.push_back({d.cast<float>(), ring, 10.f, {10.f}});
    }
  }
  return scan;
}

TEST(RangeImage, EveryOutcomeHasItsColourInItsPlace) {
  std::vector<ScanBeam> scan = small_scan();
  scan[0 * 64 + 0].ranges_m[0] = kMiss;  // false miss: lowest ring, leftmost
  scan[3 * 64 + 63].real_m = kMiss;      // false hit: highest ring, rightmost
  scan[3 * 64 + 0].ranges_m[0] = 12;     // too far: highest, leftmost
  scan[0 * 64 + 63].real_m = kMiss;      // both miss: lowest, rightmost
  scan[0 * 64 + 63].ranges_m[0] = kMiss;
  const ScanLayout layout = layout_of(scan);
  ASSERT_EQ(layout.rows, 4);
  ASSERT_EQ(layout.columns, 64);
  EXPECT_TRUE(layout.by_ring);
  const io::Image image = error_image(scan, layout, 0);
  const int right = image.width - 1, bottom = image.height - 1;
  EXPECT_EQ(at(image, 0, bottom), kFalseMiss);
  EXPECT_EQ(at(image, right, 0), kFalseHit);
  EXPECT_EQ(at(image, 0, 0), error_colour(2));
  EXPECT_EQ(at(image, right, bottom), kMissColour);
  EXPECT_EQ(at(image, image.width / 2, bottom), error_colour(0));
  EXPECT_EQ(at(range_image(scan, layout, -1, 40), right, 0), kMissColour);
  EXPECT_EQ(at(range_image(scan, layout, 0, 40), right, 0), scale_colour(0.5));
}

TEST(RangeImage, WithoutRingsRowsAreElevations) {
  std::vector<ScanBeam> scan = small_scan();
  for (ScanBeam& b : scan) b.ring = 0;
  const ScanLayout layout = layout_of(scan);
  EXPECT_FALSE(layout.by_ring);
  EXPECT_EQ(layout.rows, 64);
  EXPECT_EQ(layout_of({}).rows, 0);
}

TEST(Survey, PointsAndErrorsOfTheView) {
  BeamLog real, simulated;
  real.info.has_misses = true;
  real.resize(3000);
  for (size_t i = 0; i < real.size(); ++i) {
    const double a = 2 * M_PI * double(i) / 3000;
    real.origin[i] = {4e6, 5e6, 100};
    real.direction[i] = Vec3f(float(std::cos(a)), float(std::sin(a)), 0);
    real.range_m[i] = i % 10 == 9 ? kMiss : 20.f;
  }
  simulated = real;
  for (size_t i = 0; i < real.size(); ++i) {
    if (i % 10 == 9) simulated.range_m[i] = 10;  // false hit
    if (i % 10 == 8) simulated.range_m[i] = kMiss;
    if (i % 10 == 7) simulated.range_m[i] = 20.5f;
  }
  const io::TemporaryFolder folder;
  io::write_log(folder / "real.ply", real, "{}");
  io::write_log(folder / "sim.ply", simulated, "{}");
  const Survey s = survey({"", "", {}, folder / "real.ply", {{"simulated", folder / "sim.ply"}}});
  EXPECT_EQ(s.beams, 3000u);
  EXPECT_EQ(s.hits, 2700u);
  EXPECT_EQ(s.scan_beams.size(), 3000u);
  ASSERT_EQ(s.points.size(), 2u);
  EXPECT_EQ(s.points[0].error.size(), 2700u);  // so few that none is left out
  std::map<int, int> codes;
  for (uint8_t e : s.points[1].error) ++codes[e];
  EXPECT_EQ(codes, (std::map<int, int>{{100, 2100}, {150, 300}, {254, 300}, {255, 300}}));
  for (size_t i = 0; i < s.points[0].error.size(); ++i) {
    const double x = s.points[0].xyz[3 * i] / 65535.0 - 0.5;
    const double y = s.points[0].xyz[3 * i + 1] / 65535.0 - 0.5;
    ASSERT_NEAR(std::hypot(x, y) * s.box_m, 20, 0.002);
    ASSERT_NEAR(s.points[0].xyz[3 * i + 2] / 65535.0 * s.box_m + s.low_m - s.floor_m(), 100, 0.001);
  }
}

}  // namespace
}  // namespace underbrush::report
