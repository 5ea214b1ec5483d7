/// \file
/// Export of scans as lidar drivers publish them: one PCD file for each scan, with the fields of
/// the driver's PointCloud2 messages.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// The layout of a driver's point clouds. All have x y z as float32, m, in the sensor's frame at
/// the point's own firing (not compensated for motion); times count from the scan's, which stands
/// in times.txt.
enum class DriverLayout {
  kVelodyne,  ///< x y z, intensity float32, ring uint16, time float32 (s); hits only.
  kOuster,    ///< x y z, intensity float32, t uint32 (ns), reflectivity uint16 (the intensity,
              ///< rounded), ring uint16, ambient uint16 (0), range uint32 (mm); the first echo of
              ///< each beam. Where all rings of the scan have equally many beams, the cloud is
              ///< organised with a row for each ring and zeros for misses, else it holds hits only.
  kAutoware,  ///< x y z, intensity uint8 (rounded, at most 255), return_type uint8, channel uint16,
              ///< azimuth, elevation float32 (rad), distance float32 (m), time_stamp uint32 (ns);
              ///< hits only. The return type is 1 for a single echo. Of several, the first is 3 or
              ///< 5 and the last 4 or 6, the lower number where it is the stronger of the two;
              ///< those between are 0.
};

/// The layout of that name ("velodyne", "ouster", "autoware"). Throws `std::invalid_argument`.
DriverLayout driver_layout_from_name(const std::string& name);

/// A field of a layout: a float or an unsigned whole number of so many bytes.
struct CloudField {
  std::string name;
  unsigned bytes = 4;
  bool is_float = true;
};
/// The fields of a layout, which follow each other without gaps.
std::vector<CloudField> fields_of(DriverLayout driver);

/// The points of a scan, row after row: `width` · `height` points with the fields of the layout.
struct DriverCloud {
  size_t width = 0, height = 1;
  std::string points;
};
/// Makes the cloud of beams that belong to the scan `info`. A sensor without a pose at the time of
/// a beam has that of the scan.
DriverCloud driver_cloud(BeamLog scan, DriverLayout driver, const ScanInfo& info,
                         const Trajectory& world_from_sensor);

/// Writes the folder `path`, atomically: NNNNNN.pcd for each scan, numbered from 0, times.txt (s),
/// poses.txt (TUM, world from sensor at these times) and underbrush.json (provenance; marks the
/// folder as ours). `world_from_sensor` is the path of the sensor; if empty it is that of the log's
/// scans, or, where beams share their scan's pose, that pose. Holds one scan in memory. Throws
/// `std::invalid_argument` where a beam's scan has no pose, or a scan is not in one piece;
/// `IoError`, also if another's folder stands there.
void export_driver_layout(const std::filesystem::path& path, BeamSource& source,
                          DriverLayout driver, const Trajectory& world_from_sensor,
                          const std::string& provenance);

/// Returns the data of a log with echoes that a format cannot hold, in words; empty if it holds
/// all. `format` as for `export_log`, or the name of a driver's layout.
std::string lost_in(const std::string& format);

}  // namespace underbrush::io
