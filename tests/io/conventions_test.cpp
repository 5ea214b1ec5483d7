#include <gtest/gtest.h>

#include <cmath>

#include "formats.hpp"
#include "underbrush/core/check.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/io/mesh_file.hpp"
#include "underbrush/io/mesh_scene.hpp"
#include "underbrush/io/ply_header.hpp"
#include "underbrush/io/point_times.hpp"
#include "underbrush/io/polygon.hpp"
#include "underbrush/io/pose_columns.hpp"
#include "underbrush/io/poses.hpp"
#include "underbrush/io/table.hpp"

namespace underbrush::io {
namespace {

/// A sweep of rings with x y z, an intensity, and then a ring, a time, and two values more.
std::string floats_of(size_t columns) {
  std::vector<float> values;
  for (int k = 0; k < 600; ++k) {
    const float a = 0.01f * float(k), r = 8 + 3 * std::sin(5 * a);
    const float row[] = {r * std::cos(a),
                         r * std::sin(a),
                         -1.5f + 0.1f * float(k % 16),
                         float(k * 7 % 50),
                         float(k % 16),
                         1e-4f * float(k),
                         -5 - a,
                         0.3f * r};
    values.insert(values.end(), row, row + columns);
  }
  return {reinterpret_cast<const char*>(values.data()), 4 * values.size()};
}

TEST(BinFile, ValuesTellTheColumns) {
  const TemporaryFolder folder;
  for (const size_t columns : {4u, 5u, 6u}) {
    put_bytes(folder / "a.bin", floats_of(columns));
    const Table table = read_bin(folder / "a.bin");
    EXPECT_EQ(table.columns.size(), columns);
    EXPECT_EQ(table.size(), 600u);
    EXPECT_EQ(table.notes.empty(), columns == 4);
  }
  std::string in_turn;  // A near and a far ring fire in turn.
  for (int k = 0; k < 600; ++k) {
    const float a = 0.01f * float(k), r = k % 2 ? 20.0f + a : 5.0f;
    for (const float v : {r * std::cos(a), r * std::sin(a), -1.8f, 0.0f}) add(in_turn, v);
  }
  put_bytes(folder / "a.bin", in_turn);
  EXPECT_EQ(read_bin(folder / "a.bin").size(), 600u);
  put_bytes(folder / "a.bin", floats_of(5));
  EXPECT_EQ(read_bin(folder / "a.bin", {"x", "y", "z"}).size(), 1000u);
  EXPECT_THROW(read_bin(folder / "a.bin", {"x", "y", "z", "a", "b", "c", "d"}), FormatError);
  EXPECT_THROW(read_bin(folder / "a.bin", {"5"}), FormatError);
  for (const size_t columns : {3u, 7u, 8u}) {  // Nothing tells their names.
    put_bytes(folder / "a.bin", floats_of(columns));
    EXPECT_THROW(read_bin(folder / "a.bin"), FormatError) << columns;
  }
}

TEST(BinFile, OtherColumnsAndNumbersAreRefused) {
  const TemporaryFolder folder;
  const auto reason = [&](const std::string& bytes) {
    put_bytes(folder / "a.bin", bytes);
    return reason_of([&] { read_bin(folder / "a.bin"); });
  };
  std::string five, signed_intensity, signed_four, rings_last, doubles, big, packed, counts;
  for (int k = 0; k < 3000; ++k) {
    const float a = 0.01f * float(k), r = 8 + 3 * std::sin(5 * a), t = 3e-5f * float(k);
    const float xyz[] = {r * std::cos(a), r * std::sin(a), -1.5f + 0.1f * float(k % 16)};
    const float intensity = float(k * 7 % 50), ring = float(k % 16);
    for (std::string* s : {&five, &signed_intensity, &signed_four, &rings_last, &packed}) {
      for (const float v : xyz) add(*s, v);
    }
    add(five, intensity), add(five, t);
    add(signed_intensity, intensity / 50 - 0.5f), add(signed_intensity, ring);
    add(signed_four, intensity / 50 - 0.5f);
    add(rings_last, intensity), add(rings_last, t), add(rings_last, ring);
    add(packed, intensity), add(packed, uint32_t(33000 * k)), add(packed, uint32_t(k % 16));
    for (const float v : {xyz[0], xyz[1], xyz[2], intensity}) {
      add(doubles, double(v) + 1e-9);
      std::string bytes;
      add(bytes, v);
      big.append(bytes.rbegin(), bytes.rend());
      add(counts, uint16_t(20000 + 200 * v));
    }
  }
  EXPECT_NE(reason(five).find("5 columns"), std::string::npos);
  EXPECT_NE(reason(signed_intensity).find("5 columns"), std::string::npos);
  EXPECT_NE(reason(rings_last).find("6 columns"), std::string::npos);
  EXPECT_NE(reason(doubles).find("64-bit"), std::string::npos);
  for (const std::string& bytes : {big, packed, counts}) {
    EXPECT_NE(reason(bytes).find("no 32-bit floats"), std::string::npos);
  }
  EXPECT_EQ(reason(signed_four), "");
  EXPECT_EQ(read_bin(folder / "a.bin").size(), 3000u);
  put_bytes(folder / "a.bin", doubles);
  EXPECT_THROW(read_bin(folder / "a.bin", {"x", "y", "z", "intensity"}), FormatError);
}

TEST(Csv, LinesAboveTheRowsAreUnderstood) {
  const TemporaryFolder folder;
  for (const char* text : {"# a scan of mine\n# 2024\nx y z e\n1 2 3 9\n4 5 6 9\n",
                           "# exported by FARO Scene 2019\n1 2 3 9\n4 5 6 9\n",
                           "# x y z e\n# a line of prose behind it\n1 2 3 9\n4 5 6 9\n",
                           "X [m],Y [m],Z [m],E []\n1,2,3,9\n4,5,6,9\n",
                           ",x,y,z,e\n0,1,2,3,9\n1,4,5,6,9\n", "x,y,z,e,\n1,2,3,9,\n4,5,6,9,\n",
                           "x,y,z,e,\n1,2,3,9\n4,5,6,9\n", "x,y,z,e\n1,2,3,9,\n4,5,6,9,\n"}) {
    put_bytes(folder / "a.csv", text);
    const Table table = read_csv(folder / "a.csv");
    ASSERT_EQ(table.size(), 2u) << text;
    EXPECT_EQ(table.columns.size(), 4u) << text;
    EXPECT_EQ(doubles_of(*table.find({"y"})), (std::vector<double>{2, 5})) << text;
  }
  put_bytes(folder / "a.csv", "x,y,z,t [us]\n1,2,3,9\n");
  EXPECT_TRUE(read_csv(folder / "a.csv").find({"t_us"}));
  put_bytes(folder / "a.csv", "x [mm],y [mm],z [mm]\n1,2,3\n");
  EXPECT_FALSE(read_csv(folder / "a.csv").find({"x"}));
  for (const char* text : {"-6,71;0,5;-1,8\n", "x;y;z\n-6,71;0,5;-1,8\n", "x\ty\tz\n1,5\t2\t3\n"}) {
    put_bytes(folder / "a.csv", text);
    EXPECT_NE(reason_of([&] { read_csv(folder / "a.csv"); }).find("decimal commas"),
              std::string::npos)
        << text;
  }
}

TEST(Csv, NumbersThatCannotBeRightAreRefused) {
  const TemporaryFolder folder;
  const auto reason = [&](const std::string& text) {
    put_bytes(folder / "a.csv", text);
    return reason_of([&] { read_csv(folder / "a.csv"); });
  };
  std::string commas, counted, plain;
  for (int k = 0; k < 30; ++k) {
    const std::string n = std::to_string(k);
    commas += n + ",05,-1," + std::to_string(10 + k) + ",2,50\n";
    counted.append(n).append(" 1.5 ").append(n).append(".25 2\n");
    plain.append(n).append(".5 1.5 2.25 ").append(n).append("\n");
  }
  EXPECT_NE(reason(commas).find("decimal commas"), std::string::npos);
  EXPECT_NE(reason("x,y,z\n1,05,-1,80,2,50\n").find("decimal commas"), std::string::npos);
  EXPECT_NE(reason("x,y,z\n\"1,000.5\",2,3\n").find("within quotes"), std::string::npos);
  EXPECT_NE(reason(counted).find("counts the rows"), std::string::npos);
  EXPECT_NE(reason("x;y;z\n6 717.5;2;3\n").find("not a number"), std::string::npos);
  EXPECT_EQ(reason(plain), "");
  EXPECT_EQ(reason("1,05,2,07,0.5,08\n"), "") << "zeros in front, and points";
  put_bytes(folder / "a.csv", "sep=;\nX_m;Y_m;Z_m\n1;2;3\n");
  EXPECT_EQ(doubles_of(*read_csv(folder / "a.csv").find({"z"}))[0], 3);
}

/// The reason for which a scan of these columns is refused, and what is left out of it.
std::pair<std::string, std::map<std::string, size_t>> reason_of_scan(
    const std::vector<std::pair<std::string, std::vector<double>>>& columns) {
  Table table;
  for (const auto& [name, values] : columns) table.columns.emplace_back(name, values);
  std::map<std::string, size_t> skipped;
  std::string reason = reason_of([&] { scan_from_table("a.csv", std::move(table), {}, skipped); });
  return {std::move(reason), std::move(skipped)};
}

TEST(Scans, OtherUnitsAndAnglesAreNamed) {
  const std::vector<double> some{1, 2, 3};
  for (const char* end : {"[mm]", "_mm"}) {
    const auto name = [end](const char* axis) { return std::string(axis) + end; };
    EXPECT_NE(reason_of_scan({{name("x"), some}, {name("y"), some}, {name("z"), some}})
                  .first.find("--unit mm"),
              std::string::npos);
  }
  EXPECT_NE(reason_of_scan({{"azimuth", some}, {"elevation", some}, {"range", some}})
                .first.find("write the points as x y z"),
            std::string::npos);
  const auto near = [](double first, double step) {
    std::vector<double> out(30);
    for (int k = 0; k < 30; ++k) out[size_t(k)] = first + step * (k % 7);
    return out;
  };
  EXPECT_NE(reason_of_scan({{"x", near(8, 1e-5)}, {"y", near(49, 1e-5)}, {"z", near(200, 1)}})
                .first.find("longitude"),
            std::string::npos);
  EXPECT_EQ(reason_of_scan({{"x", near(8, 1)}, {"y", near(49, 1)}, {"z", near(2, 1)}}).first, "");
  const auto [reason, skipped] =
      reason_of_scan({{"x", some}, {"y", some}, {"z", some}, {"ring", {0, NAN, -1}}});
  EXPECT_EQ(reason, "");
  EXPECT_EQ(skipped.begin()->second, 2u) << "values of ring";
}

TEST(Pcd, FieldsTwiceAndPointsTooManyAreSaid) {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& fields, size_t bytes) {
    put_bytes(folder / "a.pcd", "FIELDS " + fields + "\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n" +
                                    "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n" +
                                    std::string(bytes, '\0'));
  };
  write("x y x", 24);
  EXPECT_THROW(read_table(folder / "a.pcd"), FormatError);
  write("x y z", 24);
  EXPECT_TRUE(read_table(folder / "a.pcd").notes.empty());
  write("x y z", 36);
  const Table table = read_table(folder / "a.pcd");
  EXPECT_EQ(table.size(), 2u);
  ASSERT_EQ(table.notes.size(), 1u);
  EXPECT_NE(table.notes[0].find("1 more points"), std::string::npos);
}

TEST(Scans, NamesThatAreMissingAreAskedFor) {
  Table table;
  for (const char* name : {"pos_x", "pos_y", "pos_z"}) {
    table.columns.emplace_back(name, std::vector<double>{1, 2});
  }
  std::map<std::string, size_t> skipped;
  const std::string reason =
      reason_of([&] { scan_from_table("a.csv", std::move(table), {}, skipped); });
  EXPECT_NE(reason.find("pos_x, pos_y, pos_z: --columns"), std::string::npos) << reason;
}

TEST(Scans, TimesHaveManyNames) {
  for (const char* name : {"ts", "timestamps", "point_time", "rel_time", "dt", "scalar_ts"}) {
    Table table;
    for (const char* axis : {"x", "y", "z"}) {
      table.columns.emplace_back(axis, std::vector<double>(101, 5));
    }
    table.columns.emplace_back(name, spread(0, 0.1));
    std::map<std::string, size_t> skipped;
    const PointScan scan = scan_from_table("f", std::move(table), {}, skipped);
    ASSERT_EQ(scan.time_s.size(), 101u) << name;
    EXPECT_NEAR(scan.time_s[50], 0.05, 1e-9) << name;
  }
}

TEST(Scans, FloatsHaveSteps) {
  Table table;
  table.columns.emplace_back("x", std::vector<float>{1, 5.4e6f, NAN});
  table.columns.emplace_back("y", std::vector<double>{1, 9e9, 1});
  EXPECT_EQ(table.step(), 0.5);
  table.columns[0].second = std::vector<double>{1, 5.4e6, 1};
  EXPECT_EQ(table.step(), 0);
}

TEST(RayCloud, NormalsAreNoRays) {
  const TemporaryFolder folder;
  const auto read = [&](double shortest, double longest, int none = 0) {
    std::string s =
        "ply\nformat binary_little_endian 1.0\nelement vertex 100\nproperty double x\nproperty "
        "double y\n"
        "property double z\nproperty double time\nproperty float nx\nproperty float ny\n"
        "property float nz\nend_header\n";
    for (int k = 0; k < 100; ++k) {
      const double length = k < none ? 0 : shortest + (longest - shortest) * k / 99;
      for (const double v : {double(k), 0.0, 0.0, double(k)}) add(s, v);
      for (const double v : {0.0, 0.6, 0.8}) add(s, float(v * length));
    }
    put_bytes(folder / "a.ply", s);
    return reason_of([&] { LogReader(folder / "a.ply"); });
  };
  for (const auto& [shortest, longest] : {std::pair(1.0, 1.0), {0.993, 1.006}, {0.75, 1.0}}) {
    EXPECT_NE(read(shortest, longest).find("normals"), std::string::npos) << shortest;
  }
  EXPECT_NE(read(1, 1, 40).find("normals"), std::string::npos) << "normals that are not known";
  EXPECT_EQ(read(0.1, 1.0), "") << "a short range";
  EXPECT_EQ(read(0.9, 1.5), "");
}

TEST(Csv, NamesAreOptionalAndCountsLeftOut) {
  const TemporaryFolder folder;
  for (const char* text :
       {"1 2 3 9\n4 5 6 9\n", "2\n1 2 3 9\n4 5 6 9\n", "//X Y Z Extra\n2\n1 2 3 9\n4 5 6 9\n",
        "\xef\xbb\xbfx,y,z,e\n1,2,3,9\n4,5,6,9\n"}) {
    put_bytes(folder / "a.xyz", text);
    const Table table = read_csv(folder / "a.xyz");
    ASSERT_EQ(table.size(), 2u) << text;
    EXPECT_EQ(doubles_of(*table.find({"y"})), (std::vector<double>{2, 5})) << text;
  }
  put_bytes(folder / "a.txt", "9 1 2 3\n");
  EXPECT_EQ(doubles_of(*read_csv(folder / "a.txt", {"i", "x", "y", "z"}).find({"z"}))[0], 3);
  put_bytes(folder / "a.txt", std::string("\xff\xfe"
                                          "x\0,\0",
                                          6));
  EXPECT_THROW(read_csv(folder / "a.txt"), FormatError);
}

double area(std::span<const Vec3> corners) {
  double sum = 0;
  for (const auto& t : triangles_of_polygon(corners)) {
    sum += (corners[t[1]] - corners[t[0]]).cross(corners[t[2]] - corners[t[0]]).norm() / 2;
  }
  return sum;
}

TEST(Polygon, TrianglesCoverConcaveOnesOnce) {
  const std::vector<Vec3> u{{3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0},
                            {1, 3, 0}, {0, 3, 0}, {0, 0, 0}, {3, 0, 0}};
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, 0.5, -0.4, 0.7).normalized();
  for (size_t first = 0; first < u.size(); ++first) {
    for (const bool reversed : {false, true}) {
      std::vector<Vec3> corners = u;
      std::rotate(corners.begin(), corners.begin() + std::ptrdiff_t(first), corners.end());
      if (reversed) std::reverse(corners.begin(), corners.end());
      for (Vec3& c : corners) c = turn * c + Vec3(100, -200, 50);
      EXPECT_EQ(triangles_of_polygon(corners).size(), 6u);
      EXPECT_NEAR(area(corners), 7, 1e-9);
    }
  }
}

TEST(Polygon, EveryReaderCutsThem) {
  const TemporaryFolder folder;
  const std::string corners = "3 3 0\n2 3 0\n2 1 0\n1 1 0\n1 3 0\n0 3 0\n0 0 0\n3 0 0\n";
  put_bytes(folder / "u.ply",
            "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n" +
                corners + "8 0 1 2 3 4 5 6 7\n");
  const MeshScene mesh = read_mesh_scene(folder / "u.ply");
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += (b - a).cross(c - a).norm() / 2;
  }
  EXPECT_NEAR(sum, 7, 1e-5);
}

TEST(Coordinates, ThoseOfAWorldAreAskedFor) {
  const auto scan_at = [](double x, double y, double unit, size_t n) {
    Table table;
    std::vector<double> c[3];
    for (size_t k = 0; k < n; ++k) {
      c[0].push_back((x + double(k % 10)) / unit);
      c[1].push_back((y + double(k / 10)) / unit);
      c[2].push_back(1 / unit);
    }
    for (size_t d = 0; d < 3; ++d) table.columns.emplace_back(std::string(1, char('x' + d)), c[d]);
    std::map<std::string, size_t> skipped;
    return scan_from_table("f", std::move(table), {{}, false, unit, nullptr}, skipped);
  };
  EXPECT_THROW(scan_at(155000, 463000, 1, 100), FormatError);
  EXPECT_THROW(scan_at(2000, 5000, 1e-3, 100), FormatError);
  EXPECT_EQ(scan_at(-5, -5, 1, 100).size(), 100u);
  EXPECT_EQ(scan_at(2000, 5000, 1, 5).size(), 5u) << "too few to tell";
  EXPECT_NEAR(scan_at(-5, -5, 1e-3, 100).point[99].x(), 4, 1e-5);
}

}  // namespace
}  // namespace underbrush::io
