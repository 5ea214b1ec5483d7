"""Ground classification by Patchwork++, beam by beam."""
import contextlib
import os
import sys
import typing

import numpy as np
import numpy.typing as npt

from .logs import Floats, Log

Booleans = npt.NDArray[np.bool_]
NEAREST_M = 1.0  # of the returns that are classified; Patchwork++ begins at 2.7, where most ground of a small robot ends


@contextlib.contextmanager
def silent() -> typing.Iterator[None]:
    """Drops what a library writes to the standard output by itself."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def sensor_height(points: Floats) -> float:
    """How high, m, the sensor stands above the ground around it, by the points (m, 3) of a scan in its own frame: the
    median over 16 sectors of the fifth percentile of the heights 1 to 8 m away."""
    away = np.hypot(points[:, 0], points[:, 1])
    near = points[(away > NEAREST_M) & (away < 8)]
    sector = np.floor((np.arctan2(near[:, 1], near[:, 0]) / (2 * np.pi) + 0.5) * 16).astype(int)
    low = [np.percentile(near[sector == k, 2], 5) for k in range(16) if (sector == k).sum() > 20]
    return -float(np.median(low))


def labels(log: Log, height_m: float) -> Booleans:
    """Whether each of the n beams ends on the ground. Patchwork++ runs over the scans in order with its own defaults, but
    from NEAREST_M on, and without its filter of reflections, which needs intensities."""
    import pypatchworkpp
    parameters = pypatchworkpp.Parameters()
    parameters.verbose = False
    parameters.enable_RNR = False
    parameters.min_range = NEAREST_M
    parameters.sensor_height = height_m
    with silent():
        classifier = pypatchworkpp.patchworkpp(parameters)
    end = log.end_points()
    out = np.zeros(len(log.scan), bool)
    for number, rows in log.scans():
        pose, points = log.world_from_sensor[number], end[rows]
        index = np.flatnonzero(~np.isnan(points[:, 0]))
        cloud = np.zeros((len(index), 4), np.float32)
        cloud[:, :3] = (points[index] - pose[:3, 3]) @ pose[:3, :3]
        classifier.estimateGround(cloud)
        out[rows.start + index[np.asarray(classifier.getGroundIndices(), int)]] = True
    return out


def share(ground: Booleans, log: Log) -> float:
    """The ground's share of the returns of a log."""
    return float(ground.sum() / (~np.isnan(log.range_m)).sum())


def agreement(real: Booleans, real_log: Log, other: Booleans, other_log: Log,
              rows: typing.Optional[Booleans] = None) -> float:
    """The share of beams that get the same label, of those that return in one of the logs of the same beams. A beam
    without a return is not ground. `rows` says which beams count."""
    counts = ~(np.isnan(real_log.range_m) & np.isnan(other_log.range_m))
    if rows is not None:
        counts &= rows
    return float((real == other)[counts].mean())
