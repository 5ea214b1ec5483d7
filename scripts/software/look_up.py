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


def nearest_scans(train: Log, test: Log, count: int) -> typing.Iterator[tuple[int, slice, list[tuple[int, slice]]]]:
    """Number and rows of each test scan, and those of the `count` training scans whose sensor stood nearest, and of
    these the nearest in time."""
    def places(log: Log) -> list[tuple[tuple[int, slice], Floats, float]]:
        return [(scan, log.origin[scan[1]].mean(axis=0), float(log.time_s[scan[1]].mean())) for scan in log.scans()]
    trained = places(train)
    for (number, rows), origin, time in places(test):
        order = sorted(trained, key=lambda place: float(np.linalg.norm(place[1] - origin)
                                                        + METRES_A_SECOND * abs(place[2] - time)))
        yield number, rows, [scan for scan, _, _ in order[:count]]


def raw(train: Log, test: Log) -> Floats:
    """The (n) ranges, m, of the test beams, NaN without a return: what the beam nearest in direction of the nearest
    training scan measured, both in the frame of the sensor."""
    out = np.full(len(test.scan), np.nan)
    for number, rows, scans in nearest_scans(train, test, 1):
        for other, near in scans:
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
    for _, rows, scans in nearest_scans(train, test, count):
        near = np.concatenate([np.arange(s.start, s.stop) for _, s in scans])
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
