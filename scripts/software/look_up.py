"""The look-up, the obvious baseline: a beam is answered with what the training beams near it measured."""
import typing

import numpy as np

from .logs import Floats, Log

NEAR = 12                # training beams that are looked at
METRES_A_SECOND = 0.01   # time decides between scans where the sensor stands


def half_spacing(log: Log) -> float:
    """Half of the median angle between neighbouring rings, rad."""
    elevation = np.empty(len(log.scan))
    for number, rows in log.scans():
        up = log.direction[rows] @ log.world_from_sensor[number][:3, 2]
        elevation[rows] = np.arcsin(np.clip(up, -1, 1))
    rings = np.unique(log.ring)
    steps = np.diff(np.sort([elevation[log.ring == ring].mean() for ring in rings]))
    return 0.5 * float(np.partition(steps, len(steps) // 2)[len(steps) // 2]) if len(steps) else 0.0035


def nearest(points: Floats, queries: Floats, count: int) -> tuple[Floats, typing.Any]:
    """Distance and index, both (m, count), of the `count` points nearest to each of the m queries."""
    from scipy.spatial import KDTree
    distance, index = KDTree(points).query(queries, k=count)
    return distance.reshape(len(queries), -1), index.reshape(len(queries), -1)


def nearest_scans(train: Log, test: Log, rows: slice, count: int) -> list[tuple[int, slice]]:
    """The `count` training scans whose sensor stood nearest to these test beams, and of these the nearest in time."""
    def distance(of: slice) -> float:
        away = np.linalg.norm(train.origin[of].mean(axis=0) - test.origin[rows].mean(axis=0))
        return float(away + METRES_A_SECOND * abs(train.time_s[of].mean() - test.time_s[rows].mean()))
    return sorted(train.scans(), key=lambda scan: distance(scan[1]))[:count]


def raw(train: Log, test: Log) -> Floats:
    """The (n) ranges, m, of the test beams, NaN without a return: what the beam nearest in direction of the nearest
    training scan measured, both in the frame of the sensor."""
    out = np.full(len(test.scan), np.nan)
    for number, rows in test.scans():
        for other, near in nearest_scans(train, test, rows, 1):
            _, index = nearest(train.direction[near] @ train.world_from_sensor[other][:3, :3],
                               test.direction[rows] @ test.world_from_sensor[number][:3, :3], 1)
            out[rows] = train.range_m[near][index[:, 0]]
    return out


def warped(train: Log, test: Log, count: int = 1) -> Floats:
    """The (n) ranges, m, of the test beams, NaN without a return. The end points of the `count` nearest training scans
    are seen from the place of the test scan; of those within half a ring's spacing of a beam the nearest in range
    counts, and where there is none, the nearest in direction. Misses keep their direction."""
    out = np.full(len(test.scan), np.nan)
    most = 2 * np.sin(half_spacing(test) / 2)
    end = train.end_points()
    for _, rows in test.scans():
        near = np.concatenate([np.arange(s.start, s.stop) for _, s in nearest_scans(train, test, rows, count)])
        away = end[near] - test.origin[rows].mean(axis=0)
        hit = ~np.isnan(train.range_m[near])
        direction = np.where(hit[:, None], away / np.linalg.norm(away, axis=1, keepdims=True), train.direction[near])
        distance, index = nearest(direction, test.direction[rows], min(NEAR, len(near)))
        counts = distance <= most
        counts[:, 0] = True
        best = np.full(len(distance), np.inf)
        for k in range(index.shape[1]):
            reach = np.linalg.norm(end[near[index[:, k]]] - test.origin[rows], axis=1)
            best = np.fmin(best, np.where(counts[:, k], reach, np.inf))
        out[rows] = np.where(np.isinf(best), np.nan, best)
    return out
