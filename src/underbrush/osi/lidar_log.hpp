/// \file
/// Conversion of the scans of a log to SensorViews with reflections, and back.
#pragma once
#include <cstdint>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/osi/sensor_view.hpp"
#include "underbrush/osi/trace.hpp"

namespace underbrush::osi {

/// The options of the conversion.
struct LidarLogOptions {
  /// Intensity of a white, perpendicular target in the log. The power that comes back is taken to
  /// be (intensity / white) / range², of that of such a target at 1 m.
  double white_intensity = 255;
  uint64_t sensor_id = 0;
};

/// Converts the rows of one scan to a SensorView of a lidar at the scan's pose. End points of beams
/// from other places are converted to directions and ranges from this pose. Rows of several echoes
/// become the rays of one beam; each beam has as many rays as the beam with the most echoes. The
/// caller sets the ground truth.
SensorView view_of(const BeamLog& rows, const ScanInfo& scan, const LidarLogOptions& options = {});

/// Appends the beams of a view to a log, and its scan to the log's scans. The frame is that of the
/// ground truth. Rings and packets are 0, because OSI has none. Throws `DataError` where the number
/// of reflections is not that of the rays, or the view has no time.
void append_beams(const SensorView& view, uint32_t scan, const LidarLogOptions& options,
                  BeamLog& log);

/// Reads the SensorViews of a trace as a log, whose range of misses is that of its farthest return,
/// rounded up, or the usual one if that is larger. Throws `FormatError`, and `DataError` for a
/// trace without reflections.
BeamLog log_of_views(TraceReader& reader, const LidarLogOptions& options);

}  // namespace underbrush::osi
