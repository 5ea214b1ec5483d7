/// \file
/// Reads two logs of the same beams scan by scan.
#pragma once
#include <functional>

#include "underbrush/core/beam_log.hpp"

namespace underbrush::metrics {

/// Receives one scan of both logs, with beam i of one beside beam i of the other.
using ScanPair = std::function<void(const BeamLog& real, const BeamLog& simulated)>;

/// Calls `visit` for each scan of two logs in order. A scan is a run of beams of one number. Memory
/// holds a scan and a chunk. Throws `DataError` where the logs differ in the number of beams or a
/// beam differs in scan or ring.
void for_each_scan(BeamSource& real, BeamSource& simulated, const ScanPair& visit);

/// Returns the rotation from the world's frame into the sensor's at the time of a scan; the
/// identity where the log has no pose for it.
Mat3 sensor_from_world(const LogInfo& info, uint32_t scan);

}  // namespace underbrush::metrics
