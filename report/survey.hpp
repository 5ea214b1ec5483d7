/// The pictures and points of the logs for a report, gathered in two passes with bounded memory.
#pragma once
#include "report/pictures.hpp"
#include "report/report.hpp"

namespace underbrush::report {

/// A part of a cloud for the three-dimensional view.
struct ViewPoints {
  std::vector<uint16_t> xyz;  ///< x, y and z of each point from the box's lower corner; its side is
                              ///< 65535 steps.
  std::vector<uint8_t> error;  ///< 0–200 stand for −1 m … 1 m; else `kFalseHitCode` or
                               ///< `kFalseMissCode`.
};
inline constexpr uint8_t kFalseHitCode = 254, kFalseMissCode = 255;

inline constexpr double kBelowLow = 3;  ///< m; the floor of the cube lies this far below `low_m`.

/// Pictures and points of the real log and the simulated ones.
struct Survey {
  size_t beams = 0, hits = 0;
  TopView view;
  /// World z (m) at the ends of the height colours, which follow the root of the height between
  /// them.
  double low_m = 0, high_m = 1;
  std::vector<io::Image> by_height;   ///< The real log's, then each simulated log's.
  std::vector<io::Image> by_error;    ///< Each simulated log's.
  uint32_t scan = 0;                  ///< The scan of the range images, in the middle of the log.
  bool scan_in_sensor_frame = false;  ///< Whether azimuths are in the sensor's frame, else in the
                                      ///< world's.
  double far_m = 1;                   ///< m; the range at the end of the colours.
  std::vector<ScanBeam> scan_beams;
  double box_m = 1;                ///< m; side of the cube that the 3-D view shows.
  std::vector<ViewPoints> points;  ///< The real log's, then each simulated log's.
};

/// Draws the logs of a report. Reads the real log twice, the simulated ones once.
Survey survey(const ReportInput& input);

}  // namespace underbrush::report
