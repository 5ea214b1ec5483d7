/// \file
/// The pattern in which a sensor fires its beams, as a log shows it.
#pragma once
#include <bitset>
#include <map>
#include <vector>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/model.hpp"

namespace underbrush::keyframes {

/// The data of a scan before its image is made.
struct Scan {
  size_t beams = 0;
  Vec3 origin = Vec3::Zero();  ///< m, world; the mean of its beams.
  Eigen::Quaterniond sensor_from_world = Eigen::Quaterniond::Identity();
};

/// Elevations of the beams of a channel, counted in steps of 0.05°. Their median is that of far
/// beams; near returns appear at other elevations where the lasers of a sensor are apart.
class ChannelElevations {
 public:
  void add(double elevation_rad);
  /// Returns the elevation (rad) below which a share of the beams is.
  double quantile(double share) const;

 private:
  static constexpr double kSteps = 3600;
  std::vector<uint32_t> count_ = std::vector<uint32_t>(size_t(kSteps));
  size_t beams_ = 0;
};

/// The directions of a log's beams in the frame of its sensor. Elevations and azimuths are those of
/// about 500 000 beams, evenly chosen.
struct ScanPattern {
  std::map<uint32_t, Scan> scans;
  std::map<uint16_t, ChannelElevations> channels;
  std::bitset<360> degrees;  ///< The degrees of azimuth at which there are beams.
  double largest_intensity = 0, largest_range_m = 0;
};

/// Finds the pattern of a log, which is read once from its beginning. Its `degrees` are found only
/// `with_azimuths`.
ScanPattern scan_pattern(BeamSource& log, bool with_azimuths = true);

/// Sets the rows and columns of an image of a scan of this pattern, which has scans. A row is a
/// channel; where a log has none, rows and columns are as wide as its beams are apart.
void set_grid(const ScanPattern& pattern, elements::Keyframes& image);

/// Whether a log of this pattern may be of the sensor that made the keyframes of `model`, which has
/// some. The names are not compared; the properties that both show of their sensor are:
///
/// - the sensor reaches as far as the farthest return of the model's log;
/// - both have channels, and half of those that both have differ by at most half a row in
///   elevation, or neither has channels, and the field of view of the keyframes, longer by a
///   quarter at both ends, holds that of the log, which may be a part of one.
///
/// Channels that one of both lacks do not count, because logs are split by channels. The azimuths
/// of `pattern` are used only where the keyframes have no channels.
bool is_of_sensor(const elements::Model& model, const LogInfo& log, const ScanPattern& pattern);

}  // namespace underbrush::keyframes
