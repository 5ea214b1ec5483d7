/// \file
/// A log as a viewer reads it: its octree, its beams by scan, and single beams.
#pragma once
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "underbrush/elements/model.hpp"
#include "underbrush/io/input.hpp"
#include "underbrush/io/log_file.hpp"
#include "underbrush/serve/octree.hpp"

namespace underbrush::serve {

/// A row of a log and the beam that it belongs to.
struct LoggedBeam {
  BeamLog rows;         ///< All rows of the beam, one for each echo.
  uint64_t number = 0;  ///< Number of the beam in the log, as `simulate` counts.
  uint64_t first = 0;   ///< Row at which the beam begins.
  size_t asked = 0;     ///< Index in `rows` of the row that was asked for.
};

/// Beams of a log that follow each other.
struct LoggedBeams {
  BeamLog beams;              ///< One row for each beam: its first echo, or its miss.
  std::vector<uint32_t> row;  ///< The row of each beam in the log.
  uint64_t number = 0;        ///< Number of the first beam in the log.
};

/// A log that is served. All functions may be called from several threads.
class LogData {
 public:
  /// `cache` is the folder of `cached_octree`.
  LogData(std::filesystem::path path, std::filesystem::path cache);
  /// Waits for a build that is under way.
  ~LogData();
  LogData(const LogData&) = delete;
  LogData& operator=(const LogData&) = delete;

  /// The state as JSON: {"state": "building", "done": 0…1}, {"state": "failed", "error": …}, or
  /// {"state": "ready", "bytes", "nodes_at", "nodes", "runs_at", "runs", "octree": description}.
  /// The first call begins to build the octree, or opens it from the cache. An octree that has to
  /// be built is {"state": "absent"} as long as no call has `build`.
  std::string state(bool build = true);
  /// The octree, or null while it is not ready.
  std::shared_ptr<const OctreeFile> octree();

  /// Returns the beams of a run (a scan, or a part of it) as bytes: their number, and the step by
  /// which rows were left out so that they are at most 200 000 (uint32 each), then 32 bytes each:
  /// origin and end relative to the octree's origin (3 × float32 each, m), row (uint32), and 1 for
  /// a hit, 0 for a miss, 2 for an inferred miss (uint32). Throws `std::invalid_argument` where
  /// there is no such run or no octree yet.
  std::string beams(size_t run);
  /// Returns the beams of a run. Throws as `beams` does, and for a run of more than 8 000 000 rows.
  LoggedBeams beams_of_run(size_t run);
  /// Returns `n` beams from number `number` on, fewer where the log ends before. Throws as
  /// `beams_of_run` does.
  LoggedBeams beams_from(uint64_t number, size_t n);
  /// Returns the sensor's path as bytes: the number of places (uint32), then for each its time
  /// since the first row (s), and x, y and z relative to the octree's origin (m), as float32. There
  /// are at most 4 000 places, at equal steps of rows. Throws as `beams` does.
  std::string trajectory();
  /// Returns a beam by one of its rows. Throws as `beams` does.
  LoggedBeam beam(uint64_t row);
  /// Whether the keyframes of a model, which must outlive this, answer beams of the log
  /// (`keyframes::KeyframeCache::serves`). A log without a sensor's name is read when it is first
  /// asked.
  bool keyframes_serve(const elements::Model& model);
  /// Describes a beam as JSON: all columns of the row, and the ranges of the beam's echoes.
  std::string beam_json(uint64_t row);

 private:
  void start();
  BeamLog rows(uint64_t first, size_t n);
  void append_run(const OctreeRun& run, uint64_t number, size_t n, LoggedBeams& out);
  BeamLog some_rows(uint64_t rows, uint64_t step);
  std::shared_ptr<const OctreeFile> needed();

  std::filesystem::path path_, cache_;
  std::mutex mutex_;  ///< Guards all below but `done_`.
  std::shared_ptr<const OctreeFile> octree_;
  std::string error_;
  bool started_ = false;
  std::atomic<double> done_{0};
  std::thread builder_;
  std::string trajectory_;  ///< Empty until it is asked for.
  std::map<const elements::Model*, bool> keyframes_serve_;
  std::unique_ptr<io::LogReader> reader_;  ///< Null for a log whose rows have no fixed places.
};

}  // namespace underbrush::serve
