#include <algorithm>
#include <array>
#include <cmath>

#include "underbrush/core/check.hpp"
#include "underbrush/io/atomic_file.hpp"
#include "underbrush/io/log_rows.hpp"
#include "underbrush/io/text.hpp"

namespace underbrush::io {
namespace {

constexpr const char* kCompactName = ".ublog";

// A name that promises another format would mislead whoever opens the file.
void check_name(const std::filesystem::path& path) {
  constexpr std::array kWrittenByPython = {".mcap", ".db3", ".bag", ".las", ".laz", ".npz"};
  constexpr std::array kOthers = {".pcd", ".csv", ".xyz", ".bin", ".e57", ".pcap", ".obj", ".osi"};
  const std::string extension = lower(path.extension().string());
  const auto is_among = [&](const auto& names) {
    return std::find(names.begin(), names.end(), extension) != names.end();
  };
  const bool by_python = is_among(kWrittenByPython);
  if (!by_python && !is_among(kOthers)) return;
  throw std::invalid_argument(path.string() + ": logs are written as .ply or .ublog here, not as " +
                              extension +
                              (by_python ? "; the command of the Python package also writes " +
                                               extension + ": pip install 'underbrush[formats]'"
                                         : ""));
}

}  // namespace

bool is_log_name(const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  return extension == ".ply" || extension == kCompactName;
}

struct LogWriter::State {
  State(const std::filesystem::path& path, const LogInfo& info, const std::string& provenance,
        const LogWriterOptions& o)
      : options(o), target(path), out(target.temporary(), path.string()) {
    comments.info = info;
    comments.provenance = provenance;
    const bool compact = lower(path.extension().string()) == kCompactName;
    require(!compact || compact_format(), "log: this program writes no compact logs");
    sink = compact ? compact_format()->begin(out, comments) : begin_ply(out, comments, options);
  }

  LogWriterOptions options;
  AtomicFile target;
  OutputFile out;
  LogComments comments;
  std::unique_ptr<LogSink> sink;
  size_t rows = 0;
  float longest_m = 0;  // of the hits
};

LogWriter::LogWriter(const std::filesystem::path& path, const LogInfo& info,
                     const std::string& provenance, const LogWriterOptions& options) {
  require(std::isfinite(info.max_range_m) && info.min_range_m >= 0 &&
              info.max_range_m > info.min_range_m,
          "log: minimum and maximum range make no sense");
  check_name(path);
  for (const ScanInfo& scan : info.scans) {
    const Pose& pose = scan.world_from_sensor;
    require(std::isfinite(scan.time_s) && pose.translation.allFinite() &&
                std::abs(pose.rotation.norm() - 1) < 1e-6,
            "log: a scan's time or pose is not finite");
  }
  state_ = std::make_unique<State>(path, info, provenance, options);
}

LogWriter::~LogWriter() = default;

void LogWriter::write(const BeamLog& chunk) {
  State& s = *state_;
  if (chunk.empty()) return;
  s.sink->write(chunk);
  s.rows += chunk.size();
  bool& has_misses = s.comments.info.has_misses;
  for (const float range : chunk.range_m) {
    if (range == kMiss) {
      has_misses = true;
    } else {
      s.longest_m = std::max(s.longest_m, range);
    }
  }
}

void LogWriter::close() {
  State& s = *state_;
  require(s.rows > 0, "log: no beams to write");
  LogInfo& info = s.comments.info;
  if (s.options.limits_from_data) {
    info.max_range_m = std::max(info.max_range_m, std::ceil(double(s.longest_m)));
  }
  s.sink->finish(s.comments);
  s.out.close();
  s.target.commit();
}

void write_log(const std::filesystem::path& path, const BeamLog& log, const std::string& provenance,
               const LogWriterOptions& options) {
  LogWriter writer(path, log.info, provenance, options);
  writer.write(log);
  writer.close();
}

}  // namespace underbrush::io
