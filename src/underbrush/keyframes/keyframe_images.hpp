/// \file
/// The range images of a log's keyframes.
#pragma once
#include <map>

#include "underbrush/core/beam_log.hpp"
#include "underbrush/elements/keyframes.hpp"
#include "underbrush/keyframes/keyframe_options.hpp"

namespace underbrush::keyframes {

/// Keyframes without weights yet, and the number of the keyframe of each scan of the log.
struct KeyframeImages {
  elements::Keyframes keyframes;
  std::map<uint32_t, uint32_t> frame_of_scan;
};

/// Chooses keyframes and makes their images. Their places are relative to `origin` (m, world). A
/// row is a channel of the sensor; where a log has none, rows and columns are as wide as its beams
/// are apart.
KeyframeImages make_keyframe_images(BeamSource& log, const Vec3& origin,
                                    const KeyframeOptions& options);

/// Adds the images of a log to those of earlier ones, in their grid, and chooses among both as
/// among the scans of one log. The pixels of earlier ones stay, in coarser units where the log has
/// farther or brighter returns.
KeyframeImages add_keyframe_images(BeamSource& log, elements::Keyframes earlier, const Vec3& origin,
                                   const KeyframeOptions& options);

/// Makes the images of a log of half as many columns: rows, units and places are those of
/// `keyframes`, and columns are twice as wide.
KeyframeImages make_half_images(BeamSource& log, const elements::Keyframes& keyframes,
                                const Vec3& origin, const KeyframeOptions& options);

}  // namespace underbrush::keyframes
