/// \file
/// Logs in others' formats.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// Writes a log atomically. Formats:
/// - "pcd": one binary PCD file; x y z of the hits (world, double), intensity, time, ring, scan,
/// packet, and the extra columns whose names are single words.
/// - "kitti": a folder with one velodyne/NNNNNN.bin a scan (float32 x y z intensity of the hits, in
/// the
///   sensor's frame at the scan's pose in `info.scans`), times.txt and poses_velo.txt.
/// - "csv": one row a beam, misses too (hit = 0, x y z at the maximum range), and the extra
/// columns.
/// - "ply": a ray cloud, as `LogWriter`.
/// An empty `format` chooses by the extension: .pcd .csv .ply, none = kitti.
/// Throws `std::invalid_argument` for an unknown format, or for "kitti" where a beam's scan has no
/// pose; `IoError`.
void export_log(const std::filesystem::path& path, BeamSource& source,
                const std::string& format = {}, const std::string& provenance = {});
/// The same of a log in memory.
void export_log(const std::filesystem::path& path, const BeamLog& log,
                const std::string& format = {}, const std::string& provenance = {});

}  // namespace underbrush::io
