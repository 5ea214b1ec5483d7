/// This file makes small files of every point format, with x y z intensity ring t of the same five
/// points.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "temporary.hpp"
#include "underbrush/core/check.hpp"

namespace underbrush::io {

struct SamplePoint {
  float x, y, z, intensity;
  uint16_t ring;
  uint32_t t_ns;
};
inline const std::array<SamplePoint, 5> kSample = {{{1, 2, 3, 0.5f, 0, 0},
                                                    {-4, 5, 0.25f, 0.25f, 1, 100},
                                                    {7, -8, 9, 1, 2, 200},
                                                    {0.5f, 11, 12, 0, 3, 300},
                                                    {13, 14, -15, 0.75f, 4, 400}}};

inline std::string sample_rows() {
  std::string s;
  for (const auto& p : kSample) {
    for (float v : {p.x, p.y, p.z, p.intensity}) add(s, v);
    add(s, p.ring), add(s, p.t_ns);
  }
  return s;
}

inline std::string sample_ply() {
  return "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\n"
         "property float y\nproperty float z\nproperty float intensity\nproperty ushort ring\n"
         "property uint t\nend_header\n" +
         sample_rows();
}

inline std::string pcd_header(const std::string& data, int points = 5) {
  const std::string n = std::to_string(points);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity ring t\nSIZE 4 4 4 4 2 4\n"
         "TYPE F F F F U U\nCOUNT 1 1 1 1 1 1\nWIDTH " +
         n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
}

inline std::string sample_pcd() { return pcd_header("binary") + sample_rows(); }

inline std::string sample_text(char separator) {
  std::string s;
  for (const auto& p : kSample) {
    std::ostringstream line;
    line << p.x << separator << p.y << separator << p.z << separator << p.intensity << separator
         << p.ring << separator << p.t_ns << "\n";
    s += line.str();
  }
  return s;
}

inline std::string sample_pcd_ascii() { return pcd_header("ascii") + sample_text(' '); }

// Compresses by LZF with literal runs only: a byte n−1 and then n bytes.
inline std::string sample_pcd_packed() {
  std::string columns, packed;
  for (int c = 0; c < 6; ++c) {
    for (const auto& p : kSample) {
      if (c < 4) add(columns, std::array{p.x, p.y, p.z, p.intensity}[size_t(c)]);
      if (c == 4) add(columns, p.ring);
      if (c == 5) add(columns, p.t_ns);
    }
  }
  for (size_t at = 0; at < columns.size(); at += 32) {
    const std::string run = columns.substr(at, 32);
    packed += char(run.size() - 1) + run;
  }
  std::string s = pcd_header("binary_compressed");
  add(s, uint32_t(packed.size())), add(s, uint32_t(columns.size()));
  return s + packed;
}

inline std::string sample_npy() {
  std::string header =
      "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('intensity', '<f4'), "
      "('ring', '<u2'), ('t', '<u4')], 'fortran_order': False, 'shape': (5,), }\n";
  std::string s = std::string("\x93NUMPY\x01\x00", 8);
  add(s, uint16_t(header.size()));
  return s + header + sample_rows();
}

inline std::string sample_npz() {
  const std::string array = sample_npy(), name = "cloud.npy";
  std::string s = "PK\3\4";
  const auto fields = [&](std::string& to) {
    for (uint16_t v : {20, 0, 0, 0, 33}) add(to, v);  // version, flags, method, time, date
    add(to, uint32_t(0)), add(to, uint32_t(array.size())), add(to, uint32_t(array.size()));
    add(to, uint16_t(name.size())), add(to, uint16_t(0));
  };
  fields(s);
  s += name + array;
  std::string directory = "PK\1\2";
  add(directory, uint16_t(20));
  fields(directory);
  for (int i = 0; i < 3; ++i) add(directory, uint16_t(0));
  add(directory, uint32_t(0)), add(directory, uint32_t(0));
  directory += name;
  const uint32_t at = uint32_t(s.size());
  s += directory + "PK\5\6";
  for (uint16_t v : {0, 0, 1, 1}) add(s, v);
  add(s, uint32_t(directory.size())), add(s, at), add(s, uint16_t(0));
  return s;
}

inline std::string sample_bin() {
  std::string s;
  for (const auto& p : kSample) {
    for (float v : {p.x, p.y, p.z, p.intensity}) add(s, v);
  }
  return s;
}

/// Evenly spread times, as those of the points of a scan.
inline std::vector<double> spread(double first, double last) {
  std::vector<double> out;
  for (int k = 0; k <= 100; ++k) out.push_back(first + (last - first) * k / 100);
  return out;
}

/// The reason of the `FormatError` that reading throws; empty where it throws none.
inline std::string reason_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const FormatError& e) {
    return e.reason();
  }
  return "";
}

}  // namespace underbrush::io
