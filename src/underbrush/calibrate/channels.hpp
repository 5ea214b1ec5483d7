/// \file
/// Range offsets of a sensor's channels, learnt from the flat surfaces in a log.
#pragma once
#include "underbrush/core/channel_offsets.hpp"

namespace underbrush::calibrate {

/// Options of `learn_offsets`.
struct ChannelOptions {
  double min_range_m = 0;        ///< Nearer returns are left out.
  double max_range_m = 40;       ///< Farther returns, where errors of angles prevail, are left out.
  double cell_m = 0.5;           ///< Side of the cells that are searched for flat surfaces.
  double prior_m = 0.03;         ///< Standard deviation of the prior of an offset.
  int rounds = 4;                ///< Rounds in which surfaces and offsets are found by turns.
  size_t most_points = 1 << 19;  ///< A longer log gives evenly spread blocks.
};

/// Learns the offsets of a log's rings in range.
///
/// A cell of space is flat if the smallest standard deviation of its returns is below 3 cm (6 cm in
/// the first round) and a third of the middle one. The returns of a ring in it, less than 73° from
/// the normal, make one observation: with the mean distance e from the cell's plane along the
/// normal n and the mean a = n · d over their directions d, e = a · offset + plane + noise. The
/// plane's three parameters are eliminated from the least squares, so that a ring is compared with
/// the others on the same surface, and all offsets are found together, as in the calibration by
/// planes of [glennie10]. A normal prior about their mean determines the offsets that the surfaces
/// leave undetermined. The mean is subtracted at the end, because an offset that all share moves
/// the surfaces instead.
///
/// Returns the rings that were seen in at least ten flat cells, with the posterior standard errors
/// (of noise alone: uneven surfaces can add some millimetres), but only if the offsets stand out:
/// the result is empty unless their root mean square is at least three times that of their standard
/// errors. It has the same bits for any number of threads; `log` is read once.
ChannelOffsets learn_offsets(BeamSource& log, const ChannelOptions& options);

}  // namespace underbrush::calibrate
