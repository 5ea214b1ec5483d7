#include <gtest/gtest.h>

#include "formats.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/pose_columns.hpp"
#include "underbrush/io/poses.hpp"

namespace underbrush::io {
namespace {

ExtraColumn whole(const std::vector<double>& values) {
  return std::vector<uint32_t>(values.begin(), values.end());
}

double last_after(double period_s, const ExtraColumn& column, const std::string& name = "t") {
  PointTimes times(period_s);
  return times.seconds("f", name, column, 5).back() - 5;
}

TEST(PointTimes, UnitIsThatWhichFitsTheScan) {
  for (const double period : {0.05, 0.1, 0.2, 1.0}) {
    const double last = 0.97 * period;
    EXPECT_NEAR(last_after(period, spread(0, last)), last, 1e-9);
    EXPECT_NEAR(last_after(period, spread(0, 1e3 * last)), last, 1e-9);
    EXPECT_NEAR(last_after(period, spread(0, 1e6 * last)), last, 1e-9);
    EXPECT_NEAR(last_after(period, whole(spread(0, 1e9 * last))), last, 1e-6);
    EXPECT_NEAR(last_after(period, whole(spread(0, 1e6 * last))), last, 1e-6);
    EXPECT_NEAR(last_after(period, whole(spread(0, 1e3 * last))), last, 2e-3);
    EXPECT_NEAR(last_after(period, spread(-last / 2, last / 2)), last / 2, 1e-9);
  }
  EXPECT_NEAR(last_after(0.1, spread(0, 0.97)), 0.097, 1e-9) << "a share of the scan";
  EXPECT_NEAR(last_after(0.1, spread(0, 0.02)), 0.02, 1e-9) << "part of a revolution";
  EXPECT_NEAR(last_after(10, spread(0, 0.1)), 0.1, 1e-9) << "every hundredth scan";
  EXPECT_NEAR(last_after(0.1, spread(0, 97), "time_ms"), 0.097, 1e-9);
  EXPECT_NEAR(last_after(0, spread(0, 80)), 80, 1e-9) << "a tripod's scan alone";
  EXPECT_NEAR(last_after(0, whole(spread(0, 97000))), 0.097, 1e-6);
  EXPECT_NEAR(last_after(0, spread(0, 97000000)), 0.097, 1e-9) << "ns, as text has them";
  EXPECT_NEAR(last_after(0, spread(0, 97000)), 0.097, 1e-9) << "µs, likewise";
}

TEST(PointTimes, CountFromTheScanOrBackOrUntilIt) {
  for (const double unit : {1.0, 1e3}) {
    PointTimes after(0.1), before(0.1, TimesCount::kBefore), until(0.1, TimesCount::kUntil);
    const std::vector<double> as_given = after.seconds("f", "t", spread(0, 0.097 * unit), 50);
    const std::vector<double> back = before.seconds("f", "t", spread(0, 0.097 * unit), 50);
    const std::vector<double> ends = until.seconds("f", "t", spread(0, 0.097 * unit), 50);
    EXPECT_NEAR(as_given.front(), 50, 1e-9);
    EXPECT_NEAR(as_given.back(), 50.097, 1e-9);
    EXPECT_NEAR(back.front(), 50, 1e-9);
    EXPECT_NEAR(back.back(), 49.903, 1e-9);
    EXPECT_NEAR(ends.front(), 49.903, 1e-9);
    EXPECT_NEAR(ends.back(), 50, 1e-9);
  }
  PointTimes until(0.1, TimesCount::kUntil);
  EXPECT_NEAR(until.seconds("f", "t", spread(1.6e9, 1.6e9 + 0.1), 1.6e9)[0], 1.6e9, 1e-6);
}

TEST(PointTimes, DatesTellTheirUnit) {
  PointTimes times(0.1);
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {
    const auto found = times.seconds("f", "t", spread(1.6e9 / unit, (1.6e9 + 0.1) / unit), 1.6e9);
    EXPECT_NEAR(found[0], 1.6e9, 1e-3);
    EXPECT_NEAR(found[100] - found[0], 0.1, 1e-5);
  }
}

TEST(PointTimes, TheFirstScanDecidesAndNothingElseIsTaken) {
  PointTimes times(0.1);
  times.seconds("f", "t", spread(0, 97), 0);
  EXPECT_NE(times.note().find("ms"), std::string::npos);
  EXPECT_NEAR(times.seconds("f", "t", spread(0, 2), 0).back(), 2e-3, 1e-9);
  EXPECT_THROW(last_after(0.1, spread(0, 3.3)), FormatError);
  EXPECT_EQ(last_after(0.1, spread(0, 0)), 0);
}

TEST(PoseColumns, NamesSayTheOrder) {
  const PoseColumns w_first{0, 1, 2, 3, 5, 6, 7, 4};
  EXPECT_EQ(pose_columns_of("#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], "
                            "q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], b_w_RS_S_x [rad]"),
            w_first);
  EXPECT_EQ(pose_columns_of("# t x y z qw qx qy qz"), w_first);
  EXPECT_EQ(pose_columns_of("time;x;y;z;rot_w;rot_x;rot_y;rot_z"), w_first);
  EXPECT_EQ(pose_columns_of("qx qy qz qw tx ty tz stamp"), (PoseColumns{7, 4, 5, 6, 0, 1, 2, 3}));
  EXPECT_EQ(pose_columns_of("timestamp,tx,ty,tz,qr,qi,qj,qk"), w_first);
  EXPECT_EQ(pose_columns_of("t x y z w i j k"), w_first);
  EXPECT_EQ(pose_columns_of("index x y z qw qx qy qz"), w_first) << "what is left is the time";
  EXPECT_EQ(pose_columns_of("t vx vy vz x y z wx wy wz qx qy qz qw"), std::nullopt);
  EXPECT_FALSE(pose_columns_of("# t x y z q0 q1 q2 q3")) << "w is first or last";
  EXPECT_FALSE(pose_columns_of("# ground truth trajectory"));
  EXPECT_FALSE(pose_columns_of("# t x y z q"));
  EXPECT_FALSE(pose_columns_of("t x x y z qx qy qz qw"));
}

TEST(PoseColumns, FilesFollowTheirHeaders) {
  const TemporaryFolder folder;
  put_bytes(folder / "p",
            "\xef\xbb\xbf#timestamp,x,y,z,qw,qx,qy,qz,v_x\n"
            "1403636580838555648,1,2,3,0.8,0,0,0.6,9\n");
  const PoseList poses = read_poses(folder / "p");
  EXPECT_NEAR(poses.pose[0].rotation.w(), 0.8, 1e-12);
  EXPECT_NEAR(poses.time_s[0], 1403636580.838555648, 1e-6);
  EXPECT_EQ(poses.notes.size(), 2u);
}

TEST(PoseColumns, PartsOfSecondsCount) {
  const TemporaryFolder folder;
  for (const auto& [names, part] : {std::pair("#sec,nsec,x,y,z,qx,qy,qz,qw", "370000000"),
                                    {"secs,nsecs,x,y,z,qx,qy,qz,qw", "370000000"},
                                    {"stamp.sec,stamp.nanosec,x,y,z,qx,qy,qz,qw", "370000000"},
                                    {"seconds,microseconds,x,y,z,qx,qy,qz,qw", "370000"}}) {
    put_bytes(folder / "p", std::string(names) + "\n98," + part + ",1,2,3,0,0,0,1\n99," + part +
                                ",1,2,3,0,0,0,1\n");
    EXPECT_NEAR(read_poses(folder / "p").time_s[1], 99.37, 1e-9) << names;
  }
  put_bytes(folder / "p", "timestamp_nsec,x,y,z,qx,qy,qz,qw\n1600000000370000000,1,2,3,0,0,0,1\n");
  EXPECT_NEAR(read_poses(folder / "p").time_s[0], 1600000000.37, 1e-6);
}

TEST(PoseColumns, HeadersThatAreNotKnownAreNamed) {
  const TemporaryFolder folder;
  const auto reason = [&](const std::string& text) {
    put_bytes(folder / "p", text);
    return reason_of([&] { read_poses(folder / "p"); });
  };
  const std::string row = "1 2 3 4 1 0 0 0\n";
  EXPECT_NE(reason("# time x y z q0 q1 q2 q3\n" + row).find("q0 q1"), std::string::npos);
  EXPECT_EQ(reason("# eight words of prose that name no column\n" + row), "");
  EXPECT_NE(reason("GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,heading,"
                   "angvel_z,angvel_y,angvel_x\n1,2,3,4,5,6,7,8,9,10,11,12,13\n")
                .find("GPSTime easting"),
            std::string::npos);
}

TEST(Poses, SquareMatricesAreThoseOfThreeRows) {
  const TemporaryFolder folder;
  put_bytes(folder / "p", "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n");
  EXPECT_EQ(read_poses(folder / "p").pose[0].translation, Vec3(5, 6, 7));
  put_bytes(folder / "p", "9 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n");
  EXPECT_EQ(read_poses(folder / "p").time_s[0], 9);
  put_bytes(folder / "p", "1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 2\n");
  EXPECT_THROW(read_poses(folder / "p"), FormatError);
}

}  // namespace
}  // namespace underbrush::io
