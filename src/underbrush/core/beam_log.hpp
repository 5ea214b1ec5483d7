/// \file
/// The log of a lidar holds every beam that was fired, with its hit or its miss.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "underbrush/core/pose.hpp"
#include "underbrush/core/ray.hpp"

namespace underbrush {

/// The least range of a log, m; a shorter range would have no direction.
inline constexpr double kLeastRangeM = 1e-6;
/// The bound of coordinates, m; larger ones do not fit on the grid of the files of logs.
inline constexpr double kMaxCoordinate = 0x1p26;

/// Range of a beam that had no return up to the sensor's maximum range.
inline constexpr float kMiss = std::numeric_limits<float>::infinity();

/// Properties of a beam besides its measurements; each is a bit of `BeamLog::flags`.
enum BeamFlag : uint8_t {
  kInferred =
      1,       ///< The log's format had dropped this miss; it was inferred from the scan pattern.
  kMover = 2,  ///< The return is of something that moved during the log (`movers::find_movers`).
};

/// Names of the extra columns of a log with several echoes a beam. Each echo is a row. The rows of
/// a beam follow each other in order of range, and a beam without an echo is one row, a miss. A row
/// whose echo is at most 1 therefore begins a beam.
inline constexpr const char* kEchoColumn = "echo";  ///< Number of the echo: 1, 2, …; 0 for a miss.
inline constexpr const char* kEchoesColumn = "echoes";  ///< Number of echoes of the row's beam.
/// Width of the echo above the threshold, m.
inline constexpr const char* kPulseWidthColumn = "pulse_width";

/// A column that a log carries besides the named ones, kept in its own type.
using ExtraColumn = std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<uint32_t>,
                                 std::vector<int8_t>, std::vector<int16_t>, std::vector<int32_t>,
                                 std::vector<float>, std::vector<double>>;

/// Returns the whole number in row i of a column; 0 for a negative one.
uint32_t whole_number(const ExtraColumn& column, size_t i);

/// A scan (one revolution or frame): its number, its reference time (s) and the sensor's pose at
/// that time.
struct ScanInfo {
  uint32_t scan = 0;
  double time_s = 0;
  Pose world_from_sensor;
};

/// Facts about a log as a whole.
struct LogInfo {
  std::string sensor;  ///< Name in the sensor catalogue; empty where unknown.
  /// The data file (YAML) of a sensor that is not in the catalogue.
  std::string sensor_file;
  double min_range_m = 0;    ///< m; the sensor reports no return nearer than this.
  double max_range_m = 120;  ///< m; a miss means that there was no return up to this range.
  bool has_misses = false;   ///< Whether the log holds beams without a return at all.
  /// The label set (`elements::labels_of`) that gives the numbers of the extra column `class` their
  /// meaning; empty where there is none.
  std::string classes;
  /// Names of the numbers of the extra column `element_class`, from 0 on; empty where they are
  /// those of `elements::Class` alone.
  std::vector<std::string> element_classes;
  bool deskewed = false;  ///< Whether each beam carries its own origin along the sensor's motion.
  std::vector<ScanInfo> scans;
};

/// Beams in columns, in firing order. All columns, extra ones included, have `size()` entries.
struct BeamLog {
  LogInfo info;
  std::vector<Vec3> origin;      ///< m, world frame.
  std::vector<Vec3f> direction;  ///< Unit vector, world frame.
  std::vector<float> range_m;    ///< m; `kMiss` where there was no return.
  std::vector<float> intensity;  ///< In the sensor's unit; 0 for a miss.
  std::vector<double> time_s;    ///< s.
  std::vector<uint16_t> ring;  ///< Channel, numbered in the order of the sensor's catalogue entry.
  std::vector<uint32_t> scan;  ///< Number of the revolution or frame.
  std::vector<uint32_t> packet;  ///< Beams with equal numbers share a sensor pose; the packet error
                                 ///< is drawn once for them.
  std::vector<uint8_t> flags;    ///< Bits of `BeamFlag`.
  std::map<std::string, ExtraColumn> extra;  ///< By name; each is as long as the log.

  size_t size() const { return range_m.size(); }
  bool empty() const { return range_m.empty(); }
  bool is_hit(size_t i) const { return range_m[i] != kMiss; }
  /// Returns the end point of a hit, or for a miss the point at the log's maximum range (m, world).
  Vec3 end_point(size_t i) const {
    const double r = is_hit(i) ? double(range_m[i]) : info.max_range_m;
    return origin[i] + r * direction[i].cast<double>();
  }
  /// The ray of a beam (world frame), its direction normalised in double precision.
  Ray ray(size_t i) const { return {origin[i], direction[i].cast<double>().normalized()}; }
  /// Whether beams without a return are in the log (otherwise hit probabilities cannot be learnt).
  bool has_misses() const { return info.has_misses; }

  /// Makes every column `n` long. New beams are misses at the origin along +x.
  void resize(size_t n);
  void reserve(size_t n);
  /// Appends beam `i` of `other`. Extra columns that both logs have are copied; an empty log takes
  /// over all extra columns of `other`. `info` does not change.
  void append(const BeamLog& other, size_t i);
  /// Appends the beams [begin, end) of `other` and treats extra columns as the overload for one
  /// beam does. Throws `std::invalid_argument` where the range leaves `other`.
  void append(const BeamLog& other, size_t begin, size_t end);
  /// Returns a log with the same `info` and the same extra columns, but without beams.
  BeamLog like() const;
  /// Throws `std::invalid_argument` if the columns' lengths differ, a direction is not a unit
  /// vector, an origin or a time is not finite, a coordinate reaches 2²⁶ m, or a range is negative
  /// or not a number.
  void check() const;
};

/// Returns why `BeamLog::check` refuses row i ("direction is not a unit vector"), or null where it
/// does not.
const char* beam_fault(const BeamLog& log, size_t i);

/// Returns for each row whether it begins a beam, by the column `echo`. Without that column every
/// row does.
std::vector<bool> begins_beam(const BeamLog& log);
/// Keeps one row for each beam: its first echo, or its miss.
void keep_first_echoes(BeamLog& log);

/// Source of beams in chunks, by which stages read a log that need not fit into memory.
class BeamSource {
 public:
  virtual ~BeamSource() = default;
  virtual const LogInfo& info() const = 0;
  /// Total number of beams.
  virtual size_t size() const = 0;
  /// Starts again at the first beam.
  virtual void rewind() = 0;
  /// Replaces `chunk` with the next beams, in order. Returns false at the end, with `chunk` empty.
  virtual bool next(BeamLog& chunk) = 0;
};

/// Returns the world origin (m) for everything derived from a log: the origin of its first beam,
/// rounded to whole metres. An empty log has none. Rewinds the source before and after.
std::optional<Vec3> log_origin(BeamSource& source);

/// Source that reads a log in memory. The log must outlive it.
class MemorySource : public BeamSource {
 public:
  explicit MemorySource(const BeamLog& log, size_t chunk_size = 1 << 20)
      : log_(log), chunk_size_(chunk_size) {}
  const LogInfo& info() const override { return log_.info; }
  size_t size() const override { return log_.size(); }
  void rewind() override { at_ = 0; }
  bool next(BeamLog& chunk) override;

 private:
  const BeamLog& log_;
  size_t chunk_size_, at_ = 0;
};

}  // namespace underbrush
