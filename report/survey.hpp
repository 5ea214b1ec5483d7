/// What a report shows of the logs themselves, gathered in two passes of bounded memory.
#pragma once
#include "report/pictures.hpp"
#include "report/report.hpp"

namespace underbrush::report {

/// A part of a cloud for the three-dimensional view.
struct ViewPoints {
  std::vector<uint16_t> xyz;   ///< Three a point, from the box's lower corner in steps of its side.
  std::vector<uint8_t> error;  ///< 0–200: −1 m … 1 m; `kFalseHitCode`; `kFalseMissCode`.
};
inline constexpr uint8_t kFalseHitCode = 254, kFalseMissCode = 255;

inline constexpr double kBelowLow = 3;  ///< m; the cube's floor lies so far below `low_m`.

/// The real and the simulated logs, drawn.
struct Survey {
  size_t beams = 0, hits = 0;
  TopView view;
  /// World z at the ends of the height colours, which go with the root of the height between them.
  double low_m = 0, high_m = 1;
  std::vector<io::Image> by_height;   ///< Real, then each simulated.
  std::vector<io::Image> by_error;    ///< Each simulated.
  uint32_t scan = 0;                  ///< The scan of the range images, in the middle of the log.
  bool scan_in_sensor_frame = false;  ///< Else its azimuth is that of the world.
  double far_m = 1;                   ///< The range at the end of the colours.
  std::vector<ScanBeam> scan_beams;
  double box_m = 1;                ///< Side of the cube that the 3-D view shows.
  std::vector<ViewPoints> points;  ///< Real, then each simulated.
};

/// Reads the logs: the real one twice, the simulated ones once.
Survey survey(const ReportInput& input);

}  // namespace underbrush::report
