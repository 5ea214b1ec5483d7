/// \file
/// Export of scans as lidar drivers publish them: one PCD file for each scan, with the fields of
/// the driver's PointCloud2 messages.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// The driver whose conventions an export follows. All of them store x y z as float32 (m) in the
/// sensor's frame at the point's own firing, so that the points are not compensated for motion.
/// Times count from the time of the scan, which stands in times.txt.
enum class Profile {
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

/// Returns the profile called "velodyne", "ouster" or "autoware". Throws `std::invalid_argument`
/// for another name.
Profile profile_from_name(const std::string& name);

/// Writes the folder `path`, atomically: a file NNNNNN.pcd for each scan, numbered from 0,
/// times.txt (s), poses.txt (TUM, world from sensor at these times) and underbrush.json (the
/// provenance, which marks the folder as ours). `world_from_sensor` is the sensor's path. If it is
/// empty, the poses of the log's scans are used, or, where beams share the pose of their scan, that
/// pose. One scan at a time is in memory. Throws `std::invalid_argument` where a beam's scan has no
/// pose or a scan's beams are not contiguous; throws `IoError`, also where a folder stands that no
/// export wrote.
void export_profile(const std::filesystem::path& path, BeamSource& source, Profile profile,
                    const Trajectory& world_from_sensor, const std::string& provenance);

/// Returns what a format cannot hold of a log with echoes, as a text for people; empty if it holds
/// all. `format` is a name for `export_log` or a profile's name.
std::string lost_in(const std::string& format);

}  // namespace underbrush::io
