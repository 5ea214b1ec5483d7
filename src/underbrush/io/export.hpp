/// \file
/// Export of logs to third-party formats.
#pragma once
#include <filesystem>
#include <string>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::io {

/// The columns with which every exported file of these formats and every table of waveforms begins.
inline constexpr const char* kCsvColumns =
    "x,y,z,ox,oy,oz,hit,time,intensity,ring,scan,packet,flags";
inline constexpr const char* kWaveformColumns = "beam,scan,ring,time,range_m,signal";
inline constexpr const char* kPcdFields = "FIELDS x y z intensity time ring scan packet";

/// Writes a log atomically, in one of these formats:
/// - "pcd": one binary PCD file with x y z of the hits (world, double), intensity, time, ring,
///   scan, packet, and the extra columns whose names are single words.
/// - "kitti": a folder with one file velodyne/NNNNNN.bin for each scan (float32 x y z intensity of
///   the hits, in the sensor's frame at the scan's pose in `info.scans`), times.txt and
///   poses_velo.txt.
/// - "csv": one row for each beam, misses included (hit = 0, x y z at the maximum range), with the
///   extra columns.
/// - "ply", "ublog": a log, as `LogWriter` writes it; in the format of the path's extension.
///
/// An empty `format` is chosen by the extension: the name without its dot; a path without one means
/// "kitti". Throws `std::invalid_argument` for an unknown format, and for "kitti" where a beam's
/// scan has no pose; throws `IoError` where the file system refuses.
void export_log(const std::filesystem::path& path, BeamSource& source,
                const std::string& format = {}, const std::string& provenance = {});
/// Writes a log that is in memory, under the rules of the overload for a source.
void export_log(const std::filesystem::path& path, const BeamLog& log,
                const std::string& format = {}, const std::string& provenance = {});

}  // namespace underbrush::io
