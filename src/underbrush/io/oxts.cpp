#include "underbrush/io/oxts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "underbrush/core/check.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".txt" && path.filename().string()[0] != '.') files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw FormatError(folder.string(), "", "no poses in it");
  return files;
}

/// The calibration in the drive's folder or above it.
std::optional<Pose> imu_from_velo(const fs::path& folder) {
  for (const fs::path& place : {folder, folder.parent_path()}) {
    const fs::path file = place / "calib_imu_to_velo.txt";
    const auto r = read_calibration(file, "R"), t = read_calibration(file, "T");
    if (!r || !t) continue;
    if (r->size() != 9 || t->size() != 3) throw FormatError(file.string(), "R, T", "damaged");
    const auto velo_from_imu =
        pose_from_rows({(*r)[0], (*r)[1], (*r)[2], (*t)[0], (*r)[3], (*r)[4], (*r)[5], (*t)[1],
                        (*r)[6], (*r)[7], (*r)[8], (*t)[2]});
    if (!velo_from_imu) throw FormatError(file.string(), "R", "not a rotation");
    return velo_from_imu->inverse();
  }
  return std::nullopt;
}

/// The numbers of a file: latitude and longitude, deg; altitude, m; roll, pitch and yaw, rad.
std::array<double, 6> numbers_of(const fs::path& file) {
  constexpr double kTurn = 2 * M_PI + 1e-3;
  constexpr std::array<double, 6> kMost{89, 360, 1e6, kTurn, kTurn, kTurn};
  constexpr std::array<double, 6> kMostDegrees{89, 360, 1e6, 360, 360, 360};
  const auto within = [](double most, double value) { return std::abs(value) <= most; };
  const NumberRows numbers = read_numbers(file);
  const auto& v = numbers.rows[0];
  std::array<double, 6> out{};
  if (v.size() >= 6 && std::equal(kMost.begin(), kMost.end(), v.begin(), within)) {
    std::copy_n(v.begin(), 6, out.begin());
    return out;
  }
  const bool degrees =
      v.size() >= 6 && std::equal(kMostDegrees.begin(), kMostDegrees.end(), v.begin(), within);
  throw FormatError(
      file.string(), "line 1",
      degrees ? "expected lat lon alt roll pitch yaw …, the angles in radians: are they in degrees?"
              : "expected lat lon alt roll pitch yaw …");
}

/// The numbers that the names of the files are; empty where one is no number.
std::vector<size_t> numbers_in_names(const std::vector<fs::path>& files) {
  constexpr double kLast = 1e7;
  std::vector<size_t> out;
  for (const fs::path& file : files) {
    const auto number = number_of(file.stem().string());
    if (!number || !(*number >= 0 && *number < kLast)) return {};
    out.push_back(size_t(*number));
  }
  return out;
}

/// The times of the poses of the files; none where there is no file of them.
std::vector<double> times_of(const fs::path& stamps, const std::vector<fs::path>& files) {
  const std::vector<size_t> number = numbers_in_names(files);
  if (!fs::exists(stamps)) {
    for (size_t i = 0; i < number.size(); ++i) {
      if (number[i] == i) continue;
      throw FormatError(files[i].string(), "",
                        "the file of number " + std::to_string(i) +
                            " is missing before it, and without " + stamps.string() +
                            " poses belong to scans by their numbers");
    }
    return {};
  }
  std::vector<double> times = read_dates(stamps);
  if (times.size() == files.size()) return times;
  if (number.empty() || number.back() >= times.size()) {
    throw FormatError(
        stamps.string(), "",
        std::to_string(times.size()) + " times for " + std::to_string(files.size()) + " poses");
  }
  std::vector<double> out;
  out.reserve(number.size());
  for (const size_t i : number) out.push_back(times[i]);
  return out;
}

}  // namespace

OxtsPoses read_oxts(const fs::path& folder) {
  constexpr double kEarthRadius = 6378137;  // m; as in KITTI's development kit.
  const std::vector<fs::path> files = files_of(folder / "oxts" / "data");
  const std::optional<Pose> calibration = imu_from_velo(folder);
  OxtsPoses out;
  out.calibrated = calibration.has_value();
  double scale = 0;
  Vec3 origin = Vec3::Zero();
  for (const fs::path& file : files) {
    const std::array<double, 6> v = numbers_of(file);
    if (scale == 0) scale = std::cos(v[0] * kDegree);
    const Vec3 place(scale * kEarthRadius * v[1] * kDegree,
                     scale * kEarthRadius * std::log(std::tan((90 + v[0]) * kDegree / 2)), v[2]);
    if (out.poses.pose.empty()) origin = place;
    const Pose world_from_imu{Eigen::AngleAxisd(v[5], Vec3::UnitZ()) *
                                  Eigen::AngleAxisd(v[4], Vec3::UnitY()) *
                                  Eigen::AngleAxisd(v[3], Vec3::UnitX()),
                              place - origin};
    out.poses.pose.push_back(world_from_imu * calibration.value_or(Pose()));
  }
  out.poses.time_s = times_of(folder / "oxts" / "timestamps.txt", files);
  return out;
}

}  // namespace underbrush::io
