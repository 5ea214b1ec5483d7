"""Pulses with several returns and means of scan angles of a survey file, collected in bounded memory."""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from .scans import Scan

Floats = npt.NDArray[np.float64]

BIN_S, _GAP_S, _GAP_OF_LINES_S = 0.1, 10.0, 1.0
_LEAST_SEPARATION_M, _STEEPEST = 0.5, 0.5  # Between first and last return; cosine of a beam's angle to the vertical.
_MOST_PULSES, _MOST_CELLS = 300_000, 1 << 20
_GROUND = 2  # Class of LAS.
_MIX = np.uint64(0x9E3779B97F4A7C15)
# Columns of the table of cells.
COUNT, TIME, X, Y, Z, ANGLE, GROUND_COUNT, GROUND_Z, LOWEST_Z, FIRST, LAST = range(11)


class PulseTable:
    """What the estimate of the sensor's positions needs of the points, and not more of them than memory can hold.

    `pulses` has a row for each pulse with several returns: time (s), first return and last return (m). Where there are
    more than 300 000, a random part of them is kept, chosen by their times. `cells` has the points of 0.1 s, of one
    whole degree of the scan angle and of one flight line: their count and sums, those of the ground, the lowest one,
    and the first and last time. Both are relative to `origin` and `start_s`.
    """

    def __init__(self) -> None:
        self.points = 0
        self.multiple = 0  #: Pulses with several returns, those that are not kept included.
        self.has_angles = False
        self.whole_angles = True  #: Whether all scan angles are whole degrees.
        self._start: tuple[float, Floats] | None = None
        self._kept = np.uint64(0xFFFFFFFFFFFFFFFF)  # Of the hashes of times, the largest that is kept.
        self._pulses: list[Floats] = []
        self._cells: list[tuple[npt.NDArray[np.int64], Floats]] = []

    @property
    def start_s(self) -> float:
        return self._start[0] if self._start else 0.0

    @property
    def origin(self) -> Floats:
        return self._start[1] if self._start else np.zeros(3)

    def add(self, scan: Scan) -> None:
        """Adds the points of a scan with world coordinates, times and numbers of returns."""
        assert scan.xyz is not None and scan.beam_time_s is not None and scan.echo is not None
        if not len(scan):
            return
        if self._start is None:
            self._start = (float(np.floor(scan.beam_time_s[0])), np.floor(scan.xyz[0]))
        time, xyz = scan.beam_time_s - self.start_s, scan.xyz - self.origin
        self.points += len(time)
        self._add_pulses(time, xyz, scan.echo)
        self._add_cells(time, xyz, scan)

    def _add_pulses(self, time: Floats, xyz: Floats, echo: npt.NDArray[np.uint8]) -> None:
        first = np.flatnonzero(echo == 1)
        last = np.append(first[1:], len(echo)) - 1
        line = xyz[first] - xyz[last]
        long = np.linalg.norm(line, axis=1)
        good = (last > first) & (long > _LEAST_SEPARATION_M) & (line[:, 2] > _STEEPEST * long)
        first, last = first[good], last[good]
        self.multiple += len(first)
        self._pulses.append(np.column_stack([time[first], xyz[first], xyz[last]])[self._chosen(time[first])])
        while sum(map(len, self._pulses)) > _MOST_PULSES:
            self._kept //= np.uint64(2)
            self._pulses = [part[self._chosen(part[:, 0])] for part in self._pulses]

    def _chosen(self, time: Floats) -> npt.NDArray[np.bool_]:
        with np.errstate(over="ignore"):
            return np.asarray(np.ascontiguousarray(time).view(np.uint64) * _MIX <= self._kept)

    def _add_cells(self, time: Floats, xyz: Floats, scan: Scan) -> None:
        angle = np.asarray(scan.extra.get("scan_angle", np.zeros(len(time))), np.float64)
        line = np.asarray(scan.extra.get("point_source_id", np.zeros(len(time))), np.int64)
        ground = np.asarray(scan.extra.get("class", np.zeros(len(time)))) == _GROUND
        self.has_angles = self.has_angles or bool(np.any(angle != angle[0]))
        self.whole_angles = self.whole_angles and bool(np.all(angle == np.rint(angle)))
        key = np.column_stack([np.floor(time / BIN_S).astype(np.int64), np.rint(angle).astype(np.int64), line])
        values = np.column_stack([np.ones(len(time)), time, xyz, angle, ground, np.where(ground, xyz[:, 2], 0),
                                  xyz[:, 2], time, time])
        self._cells.append(_reduced(key, values))
        if sum(len(one[0]) for one in self._cells) > _MOST_CELLS:
            self._cells = [_reduced(*map(np.concatenate, zip(*self._cells)))]

    def lines(self) -> list[tuple[Floats, Floats]]:
        """The pulses (n, 7) of each flight line in order of time, and its cells (k, 11), with means for sums.

        A flight line ends where no point follows for 10 s, or for 1 s where the file's number of the line changes.
        """
        if not self._cells:
            return []
        key, cells = _reduced(*map(np.concatenate, zip(*self._cells)))
        order = np.argsort(cells[:, FIRST], kind="stable")
        key, cells = key[order], cells[order]
        cells[:, TIME:GROUND_COUNT] /= cells[:, :1]
        gap = cells[1:, FIRST] - np.maximum.accumulate(cells[:, LAST])[:-1]
        ends = (gap > _GAP_S) | ((gap > _GAP_OF_LINES_S) & (key[1:, 2] != key[:-1, 2]))
        pulses = np.concatenate(self._pulses)
        pulses = pulses[np.lexsort(pulses.T[::-1])]
        parts = np.split(cells, np.flatnonzero(ends) + 1)
        starts = np.searchsorted(pulses[:, 0], [part[0, FIRST] for part in parts[1:]])
        return list(zip(np.split(pulses, starts), parts))


def _reduced(key: npt.NDArray[np.int64], values: Floats) -> tuple[npt.NDArray[np.int64], Floats]:
    """The rows of each key joined to one."""
    order = np.lexsort(key.T)
    key, values = key[order], values[order]
    begins = np.flatnonzero(np.append(True, np.any(key[1:] != key[:-1], axis=1)))
    sums = np.add.reduceat(values[:, :LOWEST_Z], begins)
    least = np.minimum.reduceat(values[:, LOWEST_Z:LAST], begins)
    return key[begins], np.column_stack([sums, least, np.maximum.reduceat(values[:, LAST], begins)])
