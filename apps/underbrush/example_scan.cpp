#include "example_scan.hpp"

#include <cmath>
#include <cstdlib>
#include <vector>

#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/sensor/beams_from_scan.hpp"

namespace underbrush::app {
namespace fs = std::filesystem;
namespace {

// Lower beams without a return were blocked by the robot that carried the sensor.
constexpr double kUnknownBelowDeg = -13;

std::vector<fs::path> shares() {
  if (const char* given = std::getenv("UNDERBRUSH_SHARE")) return {given};
  std::error_code unknown;
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  const fs::path parent = program.parent_path().parent_path();
  return {parent / "share/underbrush", parent.parent_path() / "share"};
}

}  // namespace

std::optional<fs::path> example_scan() {
  for (const fs::path& share : shares()) {
    std::error_code none;
    if (fs::is_regular_file(share / kExampleScan, none)) return share / kExampleScan;
  }
  return std::nullopt;
}

SplitStep import_example(const Verb& verb, const fs::path& scan, const fs::path& folder) {
  io::Input input = io::open_input(scan);
  sensor::BeamOptions options;
  options.recorded_unknown_below_rad = kUnknownBelowDeg * M_PI / 180;
  LogInfo info;
  info.scans = input.scan_infos;
  sensor::BeamCounts counts;
  io::LogWriter writer(folder / "log.ply", info, provenance(verb, {scan}));
  for (size_t k = 0; k < input.scans->size(); ++k) {
    writer.write(
        sensor::beams_from_scan(input.scans->read(k), input.scans->trajectory(), options, counts));
  }
  writer.close();
  HoldOut odd_columns;
  odd_columns.columns = 2;
  return split_log(verb, folder / "log.ply", odd_columns, folder / "train.ply",
                   folder / "test.ply");
}

}  // namespace underbrush::app
