/// \file
/// Table I of [deschaud12] on real logs of a standing sensor.
#pragma once
#include <string>
#include <vector>

#include "studies/study.hpp"
#include "underbrush/core/beam_log.hpp"

namespace underbrush::studies {

/// The kinds of targets in a real scan.
inline constexpr const char* kTargets[] = {"trees", "hedges", "walls", "all"};
inline constexpr size_t kTargetCount = 4;

/// Returns for each target whether each beam of a scan belongs to it. `label` is the class of each
/// beam. Walls are upright planes; trees and hedges (shrubs) are other beams of these classes by
/// `segment`. A beam belongs to a target if most returns of the seven beams about it in its ring
/// do, so that beams that pass through a target belong to it too.
std::vector<std::vector<bool>> targets_of(const BeamLog& scan, const std::vector<uint8_t>& label);

/// Adds the distances of all fitters on the logs of `run.data` whose sensor stands by its poses
/// (at most 5 cm from scan to scan): measured against simulated, and scan against scan.
void add_repeated_logs(const StudyRun& run, StudyResult& result);

}  // namespace underbrush::studies
