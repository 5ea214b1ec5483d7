/// \file
/// The counts and scores of `segment` as JSON and as text.
#pragma once
#include <map>
#include <string>

#include "cli/verb.hpp"
#include "underbrush/pipeline/segment_log.hpp"

namespace underbrush::app {

/// Returns the counts and scores as JSON; `skipped` counts the records of the log that were left
/// out, by reason.
Json json_of(const pipeline::Segmentation& segmentation, const pipeline::SegmentOptions& options,
             const std::map<std::string, size_t>& skipped);
/// Returns the counts and scores as text.
std::string text_of(const pipeline::Segmentation& segmentation,
                    const pipeline::SegmentOptions& options);

}  // namespace underbrush::app
