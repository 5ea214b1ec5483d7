#include "example_scan.hpp"

#include <cstdlib>
#include <vector>

#include "underbrush/io/log_file.hpp"
#include "underbrush/pipeline/import_log.hpp"
#include "underbrush/pipeline/split_log.hpp"

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

size_t import_example(const Verb& verb, const fs::path& scan, const fs::path& folder) {
  const fs::path file = folder / "log.ply";
  pipeline::ImportOptions options;
  options.unknown_below_deg = kUnknownBelowDeg;
  std::optional<io::LogWriter> imported;
  pipeline::import_log(
      scan, options,
      [&](const LogInfo& info) { imported.emplace(file, info, provenance(verb, {scan})); },
      [&](const BeamLog& beams) { imported->write(beams); });
  imported->close();
  pipeline::SplitOptions odd_columns;
  odd_columns.columns = 2;
  io::LogReader log(file);
  const std::string origin = provenance(verb, {file});
  io::LogWriter train(folder / "train.ply", log.info(), origin);
  io::LogWriter test(folder / "test.ply", log.info(), origin);
  const pipeline::SplitCounts n =
      pipeline::split_log(log, odd_columns, [&](const BeamLog& even, const BeamLog& odd) {
        train.write(even);
        test.write(odd);
      });
  train.close();
  test.close();
  return n.train_beams + n.test_beams;
}

}  // namespace underbrush::app
