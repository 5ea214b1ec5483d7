"""Absolute times from the clocks of sensors."""
from __future__ import annotations

import collections

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

#: Which clock is believed -> how near to the true time (s) a sensor's clock must be to be taken as set.
_AGREES_S = {"auto": 60.0, "sensor": np.inf, "capture": -1.0}
_JUMP_S = 1.0  #: A greater change of the difference between the clocks, from packet to packet, is a jump.


class Clock:
    """Turns a sensor's own stamps into absolute times, given the times at which packets were captured.

    A clock that agrees with the capture's to a minute is set (by GPS or PTP), and its stamps are taken as they are,
    also those in TAI, which is 37 s ahead of UTC. With `believed` 'sensor' every clock is, with 'capture' none is. Any
    other one only counts, so that its stamps are shifted: its first packet gets the time of its capture. After a jump
    the same choice is made anew. `period_s` is the time after which stamps begin again at 0 (Velodyne: an hour);
    `reference_s` is the true time minus the time of capture, if it is known (from GPS).
    """

    def __init__(self, period_s: float | None = None, reference_s: float = 0.0, believed: str = "auto") -> None:
        if believed not in _AGREES_S:
            raise ValueError(f"clock '{believed}' is none of {', '.join(_AGREES_S)}")
        self._agrees_s = _AGREES_S[believed]
        self.jumps = 0  #: Number of jumps so far.
        self.shift_s = 0.0  #: What is added to the stamps now (besides whole periods); 0 for a clock that is set.
        self.reference_s = reference_s
        self._period_s = period_s
        self._last: float | None = None
        self._shifts: collections.deque[float] = collections.deque(maxlen=8)  # Shifts so far, if it was not set.

    def shift(self, stamp_s: Floats, captured_s: Floats) -> Floats:
        """(n,) seconds to add to the stamps of n packets, of which both times are given, (n,) s."""
        if not len(stamp_s):
            return np.zeros(0)
        offset = stamp_s - captured_s - self.reference_s
        shift = np.zeros_like(offset)
        first = self._last is None
        if self._period_s is not None:
            near = self._last if self._last is not None else offset[0] - self._periods(offset[0])
            shift = -self._periods(offset - near)
            offset = offset + shift
        before = np.concatenate([[offset[0] if self._last is None else self._last], offset[:-1]])
        jumps = np.flatnonzero(np.abs(offset - before) > _JUMP_S)
        self.jumps += len(jumps)
        for begin, end in zip([0, *jumps], [*jumps, len(offset)]):
            if first or begin in jumps:
                self.shift_s = self._shift_of(float(offset[begin]))
            first = False
            shift[begin:end] += self.shift_s
        self._last = float(offset[-1])
        return shift

    def _shift_of(self, offset: float) -> float:
        """The shift of a clock that is ahead of the true time by `offset`."""
        if abs(offset) <= self._agrees_s:
            return 0.0
        for shift in self._shifts:
            if abs(offset + shift) <= _JUMP_S:  # It has come back, say after a single damaged stamp.
                return shift
        self._shifts.append(-offset)
        return -offset

    def _periods(self, offset: Floats) -> Floats:
        assert self._period_s is not None
        return np.round(offset / self._period_s) * self._period_s

    def found(self) -> str:
        """A line on the clock."""
        if self.shift_s == 0:
            line = "clock: the sensor's, which is set" + (" by GPS" if self.reference_s else "")
            ahead_s = (self._last or 0.0) + self.reference_s
            line += f" and {abs(ahead_s):.3f} s {'ahead of' if ahead_s > 0 else 'behind'} the capture's"
        else:
            line = f"clock: the sensor's, which is not set, so that {self.shift_s:+.6f} s were added to it"
        return line + (f"; number of jumps: {self.jumps}" if self.jumps else "")
