#include "underbrush/osi/trace.hpp"

#include <gmock/gmock.h>

#include "data.hpp"
#include "io/temporary.hpp"
#include "messages.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/osi/read.hpp"
#include "underbrush/osi/write.hpp"

namespace underbrush {
namespace {

namespace fs = std::filesystem;

class Traces : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) {
    io::put_bytes(folder_ / name, bytes);
    return folder_ / name;
  }
  io::TemporaryFolder folder_;
};

std::string framed(const std::string& message) {
  std::string out;
  for (int k = 0; k < 4; ++k) out += char(message.size() >> (8 * k));
  return out + message;
}

TEST_F(Traces, MessagesComeBack) {
  std::string view, small;
  osi::write(test::view(), view);
  osi::SensorView second;
  second.sensor_id = 5;
  osi::write(second, small);
  osi::TraceWriter writer(folder_ / "a.osi");
  writer.write(view);
  writer.write("");
  writer.write(small);
  EXPECT_FALSE(fs::exists(folder_ / "a.osi"));
  writer.close();
  EXPECT_EQ(test::read_file(folder_ / "a.osi"), framed(view) + framed("") + framed(small));
  osi::TraceReader reader(folder_ / "a.osi");
  EXPECT_EQ(reader.type(), osi::MessageType::kSensorView);
  std::string message;
  ASSERT_TRUE(reader.next(message));
  EXPECT_EQ(message, view);
  ASSERT_TRUE(reader.next(message));
  EXPECT_EQ(message, "");
  ASSERT_TRUE(reader.next(message));
  EXPECT_EQ(message, small);
  EXPECT_THAT(reader.place(), testing::EndsWith("a.osi: message 3"));
  EXPECT_FALSE(reader.next(message));
  reader.rewind();
  ASSERT_TRUE(reader.next(message));
  EXPECT_EQ(message, view);
}

std::string reason_of(const fs::path& path) {
  try {
    osi::TraceReader reader(path);
    for (std::string m; reader.next(m);) {
    }
  } catch (const FormatError& e) {
    return e.place() + ": " + e.reason();
  }
  return "";
}

TEST_F(Traces, DamageIsNamed) {
  std::string view;
  osi::write(test::view(), view);
  const std::string two = framed(view) + framed(view);
  EXPECT_EQ(reason_of(write("empty_sv_.osi", "")), ": the trace has no messages");
  EXPECT_EQ(reason_of(write("cut.osi", two.substr(0, two.size() - 1))), "message 2: truncated");
  EXPECT_EQ(reason_of(write("head.osi", framed(view) + "ab")), "message 2: truncated");
  EXPECT_EQ(reason_of(write("long.osi", framed(view) + "\xFF\xFF\xFF\x7Fxxxx")),
            "message 2: truncated");
  EXPECT_EQ(reason_of(write("huge.osi", framed(view) + "\xFF\xFF\xFF\xFFxxxx")),
            "message 2: of 2 GiB or more");
  EXPECT_THAT(reason_of(write("odd.osi", framed(""))), testing::HasSubstr("neither the name"));
  EXPECT_EQ(reason_of(write("odd_sv_.osi", framed(""))), "");
}

// Frames, moving objects of the last one, and the host's number, as the official Python package
// reads them.
struct Known {
  const char* name;
  osi::MessageType type;
  size_t frames, moving;
  uint64_t host;
};

// `bbcenter_to_rear` leads from the box's centre to the middle of the rear axle: in this trace, in
// which the wheels have a radius of 0.33 m, it ends there.
TEST(RealTraces, RearAxleIsAtTheWheels) {
  UNDERBRUSH_NEEDS_DATA("osi");
  osi::TraceReader reader(test::data_folder() / "osi" /
                          "sl-1-3_smoke_20230621T111704Z_sv_350_32112_100.osi");
  std::string m;
  ASSERT_TRUE(reader.next(m));
  const osi::SensorView v = osi::read_sensor_view(m, reader.place());
  ASSERT_TRUE(v.host());
  const Vec3 axle = osi::world_from_vehicle(*v.host()).translation;
  const Vec3 centre = *v.host()->base.position_m;
  EXPECT_NEAR(axle.z(), 0.33, 1e-9);
  EXPECT_NEAR((axle - centre).head<2>().norm(), 1.146, 1e-9);
}

TEST(RealTraces, AreRead) {
  UNDERBRUSH_NEEDS_DATA("osi");
  const Known known[] = {
      {"20240618T122540Z_sv_370_244_20_minimal_valid_example.osi", osi::MessageType::kSensorView,
       20, 2, 113},
      {"qc_example_sv_trace.osi", osi::MessageType::kSensorView, 547, 2, 1},
      {"sl-1-3_smoke_20230621T111704Z_sv_350_32112_100.osi", osi::MessageType::kSensorView, 100, 2,
       0},
  };
  for (const Known& k : known) {
    osi::TraceReader reader(test::data_folder() / "osi" / k.name);
    EXPECT_EQ(reader.type(), k.type);
    size_t moving = 0;
    double last = -1;
    for (std::string m; reader.next(m);) {
      const osi::SensorView v = osi::read_sensor_view(m, reader.place());
      ASSERT_TRUE(v.truth) << reader.place();
      EXPECT_GT(v.timestamp->s(), last);
      last = v.timestamp->s();
      moving = v.truth->moving.size();
      ASSERT_TRUE(v.host());
      EXPECT_EQ(v.host()->id, k.host);
      // What is kept of a view survives being written and read again.
      std::string once, twice;
      osi::write(v, once);
      osi::write(osi::read_sensor_view(once, "again"), twice);
      EXPECT_EQ(once, twice);
    }
    EXPECT_EQ(reader.read(), k.frames) << k.name;
    EXPECT_EQ(moving, k.moving) << k.name;
  }
}

}  // namespace
}  // namespace underbrush
