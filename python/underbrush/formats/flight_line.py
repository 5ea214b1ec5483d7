"""Least squares for the sensor's path along one flight line.

The returns of a pulse lie on a line through the sensor, so that the lines of neighbouring pulses meet where it was
[gatziolis19]. All lines of a flight line are solved at once here, with a smooth trajectory and, where the file has
them, the scan angles: the angle of a point, as seen from the sensor, across the axis of its scanner.
"""
from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from .pulses import ANGLE, BIN_S, COUNT, FIRST, GROUND_COUNT, GROUND_Z, LAST, LOWEST_Z, TIME, X, Z

Floats = npt.NDArray[np.float64]

_LEAST_PULSES, _LEAST_CELLS = 30, 12  # Fewer are not relied on.
_NODE_S, _MOST_NODES = 0.5, 500  # The sensor moves straight on between nodes.
_ACCELERATION, _CLIMB, _SPEED = 1.0, 5.0, 200.0  # m/s², m/s, m/s: standard deviations of an aircraft's motion.
_ROLL, _PITCH = np.deg2rad([1.0, 3.0])  # Standard deviations of the mean angles that scan angles leave out.
_ROUNDED, _WORST_ANGLE = np.deg2rad([0.3, 1.5])  # Of whole degrees; of angles that are no scan angles.
_ALIKE = 5  # Cells, of half a second, that share the error of their angle.
_LEAST_SPREAD = np.deg2rad(0.6)  # Standard deviation of a flight line's scan angles.
_AXIS_S = 10.0  # The direction of the scanner's axis is the same for so long.
_FIRST_RANGE_M, _ROUNDS, _HUBER_ROUNDS, _TUKEY, _SMALL_M = 1000.0, 30, 8, 4.685, 1e-4


@dataclasses.dataclass
class Solution:
    """Positions at times of a flight line and their standard errors; `reason` is why there are none."""

    time_s: Floats  #: (m,), from the first point to the last.
    position: Floats  #: (m, 3), m.
    sigma: Floats  #: (m, 3), m.
    pulses: int = 0  #: Pulses with several returns that were used.
    angles: bool = False  #: Whether scan angles were used.
    height_m: float = 0.0  #: Mean height above the points of class ground, else above the lowest points.
    reason: str = ""


def solved(pulses: Floats, cells: Floats, whole: bool) -> Solution:
    """Solves a flight line of a `PulseTable`: pulses (n, 7) in order of time, and cells (k, 11).

    `whole`: whether scan angles are rounded to degrees.
    """
    problem = _Problem(pulses, cells, whole)
    out = Solution(problem.time, problem.position, np.full((problem.nodes, 3), np.inf))
    if problem.duration <= 0:
        out.reason = "all its times are equal"
    elif not problem.use_lines and not problem.use_angles:
        few = f"only {len(pulses)} of its pulses have" if len(pulses) else "none of its pulses has"
        out.reason = f"{few} several returns, where {_LEAST_PULSES} are needed, and its scan angles differ too little"
    elif problem.solve() or (problem.use_lines and problem.solve()):
        ground = cells[:, GROUND_COUNT] > 0
        level = (np.average(cells[ground, GROUND_Z] / cells[ground, GROUND_COUNT]) if ground.any()
                 else np.average(cells[:, LOWEST_Z]))
        out.position, out.sigma = problem.position, problem.sigma
        out.pulses, out.angles = len(pulses) if problem.use_lines else 0, problem.use_angles
        out.height_m = float(problem.at(cells[:, TIME])[:, 2].mean() - level)
    else:
        out.reason = "its scan angles do not fit its points"
    return out


class _Problem:
    """Gauss-Newton steps with Huber's weights at first and Tukey's at the end.

    The unknowns are positions at nodes in time, between which the sensor moves straight on, and the mean roll and
    pitch, which scan angles leave out. A line's error at the sensor is that of its two returns, which lie L apart,
    extrapolated to the ranges R and R + L: s √((R + L)² + R²) / L, where s is estimated from the residuals.
    """

    def __init__(self, pulses: Floats, cells: Floats, whole: bool) -> None:
        self.begin, self.end = float(cells[:, FIRST].min()), float(cells[:, LAST].max())
        self.duration = self.end - self.begin
        self.nodes = min(_MOST_NODES, 1 + max(1, int(np.ceil(self.duration / _NODE_S))))
        self.time = np.linspace(self.begin, self.end, self.nodes)
        self.step = max(self.duration, 1e-9) / (self.nodes - 1)
        self.position = np.zeros((self.nodes, 3))
        self.tilt = np.zeros(2)  # Mean roll and pitch, rad.
        self.pulses, self.cells = pulses, cells
        self.first = pulses[:, 1:4]
        self.line = self.first - pulses[:, 4:]
        self.length = np.linalg.norm(self.line, axis=1)
        self.use_lines = len(pulses) >= _LEAST_PULSES
        self.seen = cells[_whole_cells(cells)] if whole else cells
        self.angle = np.deg2rad(self.seen[:, ANGLE])
        self.use_angles = len(self.seen) >= _LEAST_CELLS and float(np.std(self.angle)) > _LEAST_SPREAD

    def node(self, time: Floats) -> tuple[npt.NDArray[np.int64], Floats]:
        """The node before each time, and the next node's share of the position."""
        at = np.clip((time - self.begin) / self.step, 0, self.nodes - 1)
        before = np.minimum(at.astype(np.int64), self.nodes - 2)
        return before, at - before

    def at(self, time: Floats) -> Floats:
        """Positions (n, 3) at times."""
        before, share = self.node(time)
        return np.asarray(self.position[before] * (1 - share[:, None]) + self.position[before + 1] * share[:, None])

    def solve(self) -> bool:
        """Solves for all unknowns; False, and no angles from then on, where the angles fit nothing."""
        self.tilt[:] = 0
        self.position[:] = [*self.cells[:, X:Z].mean(axis=0), self.cells[:, Z].mean() + _FIRST_RANGE_M]
        if not self.use_lines:
            self._begin_with_angles()
        for k in range(_ROUNDS):
            self.matrix, self.vector = self._prior()
            if self.use_lines:
                self._add_lines(robust=k >= _HUBER_ROUNDS)
            if self.use_angles and (k > 2 or not self.use_lines) and not self._add_angles(robust=k >= _HUBER_ROUNDS):
                self.use_angles = False
                return False
            change = np.linalg.solve(self.matrix, -self.vector)
            self.position += change[:-2].reshape(-1, 3)
            self.tilt += change[-2:]
            if k > _HUBER_ROUNDS and np.abs(change[:-2]).max() < _SMALL_M:
                break
        bend = np.diff(self.position, 2, axis=0) / 8  # What a curve deviates from its chords.
        of_chords = np.mean(bend**2, axis=0) if len(bend) else 0
        self.sigma = np.sqrt(np.diag(np.linalg.inv(self.matrix))[:-2].reshape(-1, 3) + of_chords)
        return True

    def _begin_with_angles(self) -> None:
        """A point lies at p(t) + g tan(angle) on flat ground; the length of g is the height."""
        time = self.seen[:, TIME] - self.time.mean()
        rows = np.column_stack([np.ones(len(time)), time, np.tan(self.angle)])
        weight = np.sqrt(self.seen[:, COUNT])[:, None]
        found = np.linalg.lstsq(rows * weight, self.seen[:, X:Z] * weight, rcond=None)[0]
        self.position[:, :2] = found[0] + (self.time - self.time.mean())[:, None] * found[1]
        self.position[:, 2] = self.seen[:, Z].mean() + np.linalg.norm(found[2])

    def _prior(self) -> tuple[Floats, Floats]:
        """The normal equations of the motion of an aircraft and of the tilt."""
        n = self.nodes
        walk = np.diff(np.eye(n), axis=0) / self.step
        bend = np.diff(walk, axis=0) / self.step / _ACCELERATION
        matrix, vector = np.zeros((3 * n + 2, 3 * n + 2)), np.zeros(3 * n + 2)
        for axis, speed in enumerate((_SPEED, _SPEED, _CLIMB)):
            one = bend.T @ bend + walk.T @ walk / speed**2
            matrix[axis:-2:3, axis:-2:3] += one
            vector[axis:-2:3] += one @ self.position[:, axis]
        matrix[[-2, -1], [-2, -1]] = 1 / _ROLL**2, 1 / _PITCH**2
        vector[-2:] = self.tilt / np.array([_ROLL, _PITCH])**2
        return matrix, vector

    def _add_lines(self, robust: bool) -> None:
        """Adds how far each line through two returns passes by the sensor.

        At first this is the distance to the line, whose own error makes the distances to the sensor too short on
        average. At the end it is what the directions to both returns differ by, which has no bias.
        """
        offset = self.at(self.pulses[:, 0]) - self.first
        nearer, farther = np.linalg.norm(offset, axis=1), np.linalg.norm(offset + self.line, axis=1)
        if robust:
            sight = offset + self.line / 2
            sight /= np.linalg.norm(sight, axis=1)[:, None]
            length = np.maximum(farther - nearer, _SMALL_M)
            miss = offset - self.line * (nearer / length)[:, None]
        else:
            sight, length, miss = self.line / self.length[:, None], self.length, offset
        across = np.eye(3) - sight[:, :, None] * sight[:, None, :]
        residual = np.einsum("nij,nj->ni", across, miss)
        sigma = np.hypot(nearer, farther) / length
        size = np.linalg.norm(residual, axis=1) / sigma
        scale = max(float(np.median(size)) / np.sqrt(2 * np.log(2)), 1e-6)  # The median of a Rayleigh distribution.
        weight = _weights(size / scale, robust) / (scale * sigma)**2
        self._add(self.pulses[:, 0], across, residual, np.zeros((len(size), 3, 2)), weight)

    def _add_angles(self, robust: bool) -> bool:
        """Adds the angles across the scanner's axis and, where the mean pitch is, along it."""
        offset = self.seen[:, X:Z + 1] - self.at(self.seen[:, TIME])
        right = self._right(offset)
        for k, (toward, angle) in enumerate(((right, self.angle),
                                             (right[:, ::-1] * [1, -1], np.zeros(len(right))))):
            flat, down = np.einsum("ni,ni->n", toward, offset[:, :2]), -offset[:, 2]
            residual = np.arctan2(flat, down) - angle - self.tilt[k]
            scale = float(np.median(np.abs(residual))) * 1.4826
            if robust and scale > _WORST_ANGLE:
                return False
            gradient = np.column_stack([-toward * down[:, None], -flat]) / (flat**2 + down**2)[:, None]
            of_tilt = np.zeros((len(right), 1, 2))
            of_tilt[:, 0, k] = -1
            scale = max(scale, float(_ROUNDED)) * np.sqrt(_ALIKE)
            self._add(self.seen[:, TIME], gradient[:, None], residual[:, None], of_tilt,
                      _weights(np.abs(residual) * np.sqrt(_ALIKE) / scale, robust) / scale**2)
        return True

    def _right(self, offset: Floats) -> Floats:
        """Unit vectors (k, 2) in which the scan angle rises, estimated from the points of each 10 s."""
        group = ((self.seen[:, TIME] - self.begin) / _AXIS_S).astype(np.int64)
        count = self.seen[:, COUNT]
        rows = np.column_stack([np.tan(self.angle) * -offset[:, 2], offset[:, :2]])
        total = np.maximum(np.bincount(group, count), 1e-9)
        rows -= np.column_stack([np.bincount(group, count * c) / total for c in rows.T])[group]
        slope = np.column_stack([np.bincount(group, count * rows[:, 0] * c) for c in rows[:, 1:].T])
        slope[np.bincount(group, count * rows[:, 0]**2) < 1e-3 * np.bincount(group, count * rows[:, 0]**2).max()] = 0
        size = np.linalg.norm(slope, axis=1)
        slope[size == 0] = slope.sum(axis=0)
        return np.asarray((slope / np.maximum(np.linalg.norm(slope, axis=1), 1e-12)[:, None])[group])

    def _add(self, time: Floats, gradient: Floats, residual: Floats, of_tilt: Floats, weight: Floats) -> None:
        """Adds n observations of r residuals (n, r), with derivatives by position (n, r, 3) and tilt (n, r, 2)."""
        before, share = self.node(time)
        order = np.argsort(before, kind="stable")
        ends = np.searchsorted(before[order], np.arange(self.nodes))
        for node in range(self.nodes - 1):
            rows = order[ends[node]:ends[node + 1]]
            if not len(rows):
                continue
            s = share[rows, None, None]
            jacobian = np.concatenate([gradient[rows] * (1 - s), gradient[rows] * s, of_tilt[rows]], axis=2)
            weighted = (jacobian * weight[rows, None, None]).reshape(-1, 8)
            at = np.append(np.arange(3 * node, 3 * node + 6), [3 * self.nodes, 3 * self.nodes + 1])
            self.matrix[np.ix_(at, at)] += weighted.T @ jacobian.reshape(-1, 8)
            self.vector[at] += weighted.T @ residual[rows].reshape(-1)


def _weights(size: Floats, robust: bool) -> Floats:
    """Weights of residuals in standard deviations: Tukey's, or Huber's to begin with."""
    if not robust:
        return np.asarray(1 / np.maximum(size, 1))
    return np.asarray(np.where(size < _TUKEY, (1 - (size / _TUKEY)**2)**2, 0))


def _whole_cells(cells: Floats) -> npt.NDArray[np.bool_]:
    """Cells but for those of the first and the last angle of a time, whose points may not fill the degree."""
    time, angle = np.floor(cells[:, FIRST] / BIN_S).astype(np.int64), cells[:, ANGLE]
    group = np.unique(time, return_inverse=True)[1].reshape(-1)
    least, most = np.full(group.max() + 1, np.inf), np.full(group.max() + 1, -np.inf)
    np.minimum.at(least, group, angle)
    np.maximum.at(most, group, angle)
    return np.asarray((angle > least[group]) & (angle < most[group]))
