/// The pictures and points of the logs for a report, gathered in two passes with bounded memory.
#pragma once
#include "report/comparison.hpp"
#include "report/pictures.hpp"

namespace underbrush::report {

/// A part of a cloud for the three-dimensional view.
struct ViewPoints {
  std::vector<uint16_t> xyz;  ///< x, y and z of each point from the box's lower corner; its side is
                              ///< 65535 steps.
  std::vector<uint8_t> error;  ///< 0–200 stand for −1 m … 1 m; else `kFalseHitCode` or
                               ///< `kFalseMissCode`.
};
inline constexpr uint8_t kFalseHitCode = 254, kFalseMissCode = 255;

/// The real and the simulated logs, drawn.
struct Survey {
  size_t beams = 0, hits = 0;
  TopView view;
  /// World z (m) at the ends of the height colours, which follow the root of the height between
  /// them.
  double low_m = 0, high_m = 1;
  std::vector<io::Image> by_height;   ///< Pictures of the real log, then of each simulated log.
  std::vector<io::Image> by_error;    ///< A picture of each simulated log.
  uint32_t scan = 0;                  ///< The scan of the range images, in the middle of the log.
  bool scan_in_sensor_frame = false;  ///< Whether azimuths are in the sensor's frame, else in the
                                      ///< world's.
  double far_m = 1;                   ///< m; the range at the end of the colours.
  std::vector<ScanBeam> scan_beams;
  double box_m = 1;                ///< Side of the cube that the 3-D view shows.
  bool box_holds_all = false;      ///< All but the outermost points; else those near the sensor.
  std::vector<ViewPoints> points;  ///< Points of the real log, then of each simulated log.

  /// The distance of the cube's floor below `low_m`, m.
  double floor_m() const { return box_m / 20; }
};

/// Reads the logs: the real one twice, the simulated ones once.
Survey survey(const Comparison& input);

}  // namespace underbrush::report
