/// \file
/// The log of a lidar: every beam that was fired, with its hit or its miss.
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

/// Range of a beam that had no return up to the sensor's maximum range.
inline constexpr float kMiss = std::numeric_limits<float>::infinity();

/// What else is known of a beam (bits of `BeamLog::flags`).
enum BeamFlag : uint8_t {
  kInferred =
      1,  ///< The log's format had dropped this miss; it was inferred from the scan pattern.
};

/// Names of the extra columns of a log with echoes. An echo is a row; the rows of a beam follow
/// each other in order of range, and a beam without an echo is one row, a miss. So a row with echo
/// ≤ 1 begins a beam.
inline constexpr const char* kEchoColumn = "echo";               ///< 1, 2, …; 0 for a miss.
inline constexpr const char* kEchoesColumn = "echoes";           ///< How many that beam has.
inline constexpr const char* kPulseWidthColumn = "pulse_width";  ///< m, above the threshold.

/// A field that the log carries besides the named ones, kept in its own type.
using ExtraColumn = std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<uint32_t>,
                                 std::vector<int8_t>, std::vector<int16_t>, std::vector<int32_t>,
                                 std::vector<float>, std::vector<double>>;

/// A scan (one revolution or frame): its number, reference time and sensor pose at that time.
struct ScanInfo {
  uint32_t scan = 0;
  double time_s = 0;
  Pose world_from_sensor;
};

/// What a log says of itself as a whole.
struct LogInfo {
  std::string sensor;        ///< Catalogue name, or empty where unknown.
  double min_range_m = 0;    ///< The sensor reports nothing nearer.
  double max_range_m = 120;  ///< A miss means: no return up to here.
  bool has_misses = false;   ///< Whether beams without a return are in the log at all.
  /// What the numbers of the extra column `class` mean: a label set (`elements::labels_of`), or
  /// empty.
  std::string classes;
  bool deskewed = false;  ///< Whether each beam carries its own origin along the sensor's motion.
  std::vector<ScanInfo> scans;
};

/// Beams in columns, in firing order. All non-optional columns have `size()` entries.
struct BeamLog {
  LogInfo info;
  std::vector<Vec3> origin;      ///< m, world frame.
  std::vector<Vec3f> direction;  ///< Unit vector, world frame.
  std::vector<float> range_m;    ///< m; `kMiss` where there was no return.
  std::vector<float> intensity;  ///< Sensor units, 0 for a miss.
  std::vector<double> time_s;    ///< s.
  std::vector<uint16_t> ring;    ///< Channel, in the order of the sensor's catalogue entry.
  std::vector<uint32_t> scan;    ///< Revolution or frame.
  std::vector<uint32_t> packet;  ///< Beams sharing a sensor pose: the unit of the packet error.
  std::vector<uint8_t> flags;    ///< Bits of `BeamFlag`.
  std::map<std::string, ExtraColumn> extra;  ///< By name, each as long as the log.

  size_t size() const { return range_m.size(); }
  bool empty() const { return range_m.empty(); }
  bool is_hit(size_t i) const { return range_m[i] != kMiss; }
  /// End point of a hit (m, world); of a miss, the point at the log's maximum range.
  Vec3 end_point(size_t i) const {
    const double r = is_hit(i) ? double(range_m[i]) : info.max_range_m;
    return origin[i] + r * direction[i].cast<double>();
  }
  /// The ray of a beam (world frame), its direction normalised in double precision.
  Ray ray(size_t i) const { return {origin[i], direction[i].cast<double>().normalized()}; }
  /// Whether beams without a return are in the log (otherwise hit probabilities cannot be learnt).
  bool has_misses() const { return info.has_misses; }

  /// Makes every column `n` long; new beams are misses at the origin along +x.
  void resize(size_t n);
  void reserve(size_t n);
  /// Appends beam `i` of `other`, with the extra columns that both logs have (a column new to an
  /// empty log is taken over). `info` stays.
  void append(const BeamLog& other, size_t i);
  /// Appends beams [begin, end) of `other`; likewise.
  void append(const BeamLog& other, size_t begin, size_t end);
  /// The same columns and `info`, no beams.
  BeamLog like() const;
  /// Throws `std::invalid_argument` if the columns' lengths differ.
  void check() const;
};

/// Which rows begin a beam, as the column `echo` says; without it all do.
std::vector<bool> begins_beam(const BeamLog& log);
/// Leaves one row a beam: of several echoes the first.
void keep_first_echoes(BeamLog& log);

/// Beams in chunks: how stages read a log that need not fit into memory.
class BeamSource {
 public:
  virtual ~BeamSource() = default;
  virtual const LogInfo& info() const = 0;
  /// Total number of beams.
  virtual size_t size() const = 0;
  /// Starts again at the first beam.
  virtual void rewind() = 0;
  /// Replaces `chunk` with the next beams, in order; false at the end (and `chunk` is empty).
  virtual bool next(BeamLog& chunk) = 0;
};

/// The world origin for what is made of a log: that of its first beam on whole metres; none for an
/// empty log. Rewinds the source before and after.
std::optional<Vec3> log_origin(BeamSource& source);

/// A log in memory as a source. The log must outlive it.
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
