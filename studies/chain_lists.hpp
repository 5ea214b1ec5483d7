/// \file
/// Lists of objects that the chain of strategies of the FMU makes of a simulated drive.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "studies/moving_objects.hpp"
#include "underbrush/perception/objects.hpp"

namespace underbrush::studies {

/// The world in which a drive is simulated.
struct ChainWorld {
  elements::Model world;  ///< The static world.
  std::vector<actors::Track> tracks;
  std::vector<elements::Model> models;  ///< The model of each track, in the frame of its box.
};

/// Lists of the tracking model and of the real pipeline, one for each scan.
struct ChainLists {
  std::vector<perception::ObjectList> model, pipeline;
};

/// Runs the strategies of the FMU (tracer, front_end, alignment and tracking with its parameters
/// `tracking`) on the truth of each scan of a log. The tracer stands where the log's sensor stood
/// at the time of the scan, and fires all its beams then, each with the sub-rays of the sensor's
/// file. Throws `std::invalid_argument` for a log that does not name its sensor.
ChainLists chain_lists(const LogInfo& log, const perception::LogTruth& truth,
                       const ChainWorld& world, const std::map<std::string, std::string>& tracking,
                       uint64_t seed);

}  // namespace underbrush::studies
