"""Speed, revolutions and firings of a spinning sensor from its azimuths and stamps."""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_MAX_DEG_PER_S = 12_000.0  #: A little above 30 revolutions a second, which no model exceeds.


class Rotation:
    """Follows the azimuth: speed of rotation and number of the revolution."""

    def __init__(self, start_deg: float, step_s: float) -> None:
        """`start_deg` (clockwise) is where a revolution begins, `step_s` the time between two azimuths."""
        self._start_deg, self._step_s = start_deg, step_s
        self._azimuth_deg: float | None = None
        self._time_s = self._rate = self._way_deg = self._turn = 0.0

    def advance(self, azimuth_deg: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """Rate (deg/s) and number of the revolution, (n,), of firings at (n,) clockwise azimuths and times."""
        if not len(azimuth_deg):
            return np.zeros(0), np.zeros(0)
        if self._azimuth_deg is None:
            self._azimuth_deg, self._time_s = float(azimuth_deg[0]), float(time_s[0])
            self._way_deg = (self._azimuth_deg - self._start_deg) % 360
        # It turns clockwise only. Less than a degree back is jitter; more is a sector in which it does not fire.
        step = (np.diff(azimuth_deg, prepend=self._azimuth_deg) + 1) % 360 - 1
        interval = np.diff(time_s, prepend=self._time_s)
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = step / interval  # From the firing before to this one.
        steady = (interval > 0) & (interval < 2.5 * self._step_s) & (rate >= 0) & (rate < _MAX_DEG_PER_S)
        before = _filled(rate, steady, self._rate)
        gap = interval > 2.5 * self._step_s
        step = step + np.where(gap, np.round((before * interval - step) / 360) * 360, 0)
        way = self._way_deg + np.cumsum(step)
        turn = np.maximum(np.maximum.accumulate(np.floor(way / 360)), self._turn)
        after = _filled(np.append(rate[1:], 0.0), np.append(steady[1:], False), float(before[0]))
        self._azimuth_deg, self._time_s = float(azimuth_deg[-1]), float(time_s[-1])
        self._rate, self._way_deg, self._turn = float(after[-1]), float(way[-1]), float(turn[-1])
        return after, turn


def _filled(values: Floats, valid: npt.NDArray[np.bool_], first: float) -> Floats:
    """`values`, where one that is not valid is the last valid one before it, or `first`, or else the next valid one."""
    index = np.maximum.accumulate(np.where(valid, np.arange(len(values)), -1))
    if first == 0 and valid.any():
        first = float(values[np.argmax(valid)])
    return np.where(index >= 0, values[index], first)


def firing_period(steps: Floats, captured_s: Floats, firings: int, nominal_s: float) -> tuple[float, bool]:
    """Time of a firing (s) and whether the packets have stamps at all.

    Firmware differs: the period that the stamps show is taken where it is more than 1 % off the nominal one. `steps`
    (n - 1,) are the times between the stamps of n packets of `firings` each, which were captured at (n,) `captured_s`.
    """
    if len(steps) < 8:
        return nominal_s, True
    usual = steps[np.abs(steps / (firings * nominal_s) - 1) < 0.25]
    if len(usual) < len(steps) / 2:
        captured_steps = np.diff(captured_s)
        return nominal_s, bool(abs(np.median(steps) - np.median(captured_steps)) < 0.5 * np.median(captured_steps))
    period_s = float(usual.mean()) / firings
    return (period_s if abs(period_s / nominal_s - 1) > 0.01 else nominal_s), True
