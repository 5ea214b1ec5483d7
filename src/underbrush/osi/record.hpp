/// \file
/// This file writes a log as a trace of SensorViews.
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "underbrush/osi/lidar_log.hpp"
#include "underbrush/osi/trace.hpp"
#include "underbrush/perception/log_truth.hpp"

namespace underbrush::osi {

/// The numbers of messages, of rays and of true objects; an object counts once per message.
struct RecordCounts {
  size_t views = 0, rays = 0, objects = 0;
};

/// Writes a SensorView with reflections for each scan of a log, with the true objects unless
/// `truth` is null, of which object k + 1 refers to the k-th of `models`. The host vehicle is where
/// the sensor is. The writer is not closed. A log without poses of scans is read once more, and the
/// places of their first beams are taken. Throws `DataError` for a log without beams, or with a
/// beam whose scan has no pose.
RecordCounts record_log(BeamSource& log, const perception::LogTruth* truth,
                        const LidarLogOptions& options, TraceWriter& writer,
                        std::span<const std::string> models = {});

}  // namespace underbrush::osi
