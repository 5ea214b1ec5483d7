"""The unit of the times that a recording gives its points."""
from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import Array, PathLike

Floats = npt.NDArray[np.float64]

_LONGEST_OFFSET_S = 100.0  # A larger time is not an offset within a scan but absolute.
_DATES_S = (1e9, 4.2e9)  # Seconds since 1970: the years 2001 to 2103.
_LONGEST_SCAN_S = 1e4
_LATE_S = 1.0  # After the stamp; a later first point is of another clock.
_ENOUGH = 20  # Points of a scan; fewer do not determine the unit.
_UNITS = (("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3), ("s", 1.0))

_SUFFIXES = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
_USELESS = "the points' times ({}) {}: the motion within a scan is not compensated"


class PointTimes:
    """Turns columns of times into seconds; the unit is determined from the first scan of at least 20 points.

    Whole numbers are ns and others s, if that fits: the times of a scan span at most 1.3 of the period and at least a
    twentieth of it or 20 ms. Else the unit is the one of ns, µs, ms and s that fits, or the values are shares of the
    scan's period. Where the period is not known, times of 1 ms and more fit in the usual unit, and 10 ms to 1 s in
    others. A suffix _ns, _us, _ms or _s of the name gives the unit. This is the rule of the program, too
    (io/point_times.hpp). Times that are all equal, and floats whose steps are longer than a twentieth of the period,
    are not the times of points: `note` has a message, and the latter become the stamp. Times that are not absolute
    `count` "after" the stamp, "before" it (back from the last point, which has 0), or "until" it, the time of the last
    point.
    """

    def __init__(self, path: PathLike, period_s: float = 0.0, unit_s: float = 0.0, count: str = "after") -> None:
        self._path, self._period, self._count = path, period_s, count
        self._unit = unit_s  # Known from the start if the format defines it.
        self.note = ""  #: What was assumed; empty where the unit is the usual one.

    def _fits(self, span: float, usual: bool) -> bool:
        if self._period > 0:
            return min(0.05 * self._period, 0.02) <= span <= 1.3 * self._period
        return span >= 1e-3 if usual else 0.01 <= span <= 1

    def _unit_of(self, name: str, usual: float, low: float, span: float, count: int) -> float:
        suffix = name.rpartition("_")[2] if "_" in name else ""
        if suffix in _SUFFIXES:
            self._unit = _SUFFIXES[suffix]
            return self._unit
        whole = usual == 1e-9
        for _, unit in _UNITS:
            is_date = _DATES_S[0] < low * unit < _DATES_S[1] and span * unit < _LONGEST_SCAN_S
            if is_date and (not whole or unit == usual or self._fits(span * unit, False)):
                return unit
        if self._unit or span == 0 or count < _ENOUGH:
            return self._unit or usual
        if self._fits(span * usual, True):
            self._unit = usual
            return usual
        spans = f"{span:.4g} of them where scans are {self._period or 0.1:.4g} s apart"
        for text, unit in _UNITS:
            if unit != usual and self._fits(span * unit, False):
                self._unit = unit
                self.note = f"the points' times ({name}) are taken to be {text}: a scan spans {spans}"
                return unit
        if not whole and low >= 0 and low + span <= 1.001 and self._fits(span * self._period, False):
            self._unit = self._period
            self.note = f"the points' times ({name}) are taken to be shares of a scan, 0 to 1: it spans {spans}"
            return self._unit
        if low <= 2 * span and self._period > 0 and span * usual > 1.3 * self._period:
            raise FormatError(self._path, name, f"the points' times are neither ns, µs, ms, s nor shares of a scan: "
                                                f"it spans {spans}")
        return usual

    def seconds(self, name: str, column: Array, stamp_s: float, usual_s: float = 0.0) -> Floats:
        """Times in s: absolute ones as they are, others after the stamp. Raises `FormatError` where no unit fits.

        `usual_s` is the unit (s) that a driver is known to use, 0 = not known.
        """
        values = column.astype(np.float64)
        finite = values[np.isfinite(values)]
        if not len(finite):
            return values
        low, high = float(finite.min()), float(finite.max())
        whole = column.dtype.kind in "iu" or max(-low, high) > 1e15
        unit = self._unit_of(name, usual_s or (1e-9 if whole else 1.0), low, high - low, len(finite))
        absolute = max(-low, high) * unit > _LONGEST_OFFSET_S
        if low == high and len(finite) >= _ENOUGH:
            self.note = _USELESS.format(name, f"are all {low:g}")
        step = float(np.spacing(np.float32(max(-low, high)))) * unit if column.dtype.itemsize == 4 and not whole else 0.0
        if step > 0.05 * (self._period or 0.1):
            self.note = _USELESS.format(name, f"are floats of 4 bytes in steps of {step:.2g} s, so that they are not used")
            return np.full(len(values), stamp_s)
        if not absolute and self._count != "after":
            return np.asarray(stamp_s + unit * (-values if self._count == "before" else values - high))
        begin = 0.0 if absolute else stamp_s
        if self._period > 0 and not absolute and high > low and low * unit > _LATE_S:
            begin -= low * unit
            self.note = self.note or (f"the points' times ({name}) count from the scan's time, since their clock is "
                                      f"another one: the first is {low * unit:.4g} s")
        return np.asarray(values * unit + begin)


def turn_by(xyz: Floats, times_s: Floats) -> float:
    """The angle (rad, counter-clockwise from above) through which points (n, 3) turn as their times (n,) rise, within
    at most one revolution; 0 where they do not turn evenly."""
    parts = 36
    known = np.isfinite(xyz[:, 0]) & np.isfinite(times_s)
    if np.count_nonzero(known) < _ENOUGH or np.ptp(times_s[known]) <= 0:
        return 0.0
    time = times_s[known] - times_s[known].min()
    part = np.minimum(parts - 1, (parts * time / time.max()).astype(np.intp))
    angle = np.arctan2(xyz[known, 1], xyz[known, 0])
    facing = np.bincount(part, np.cos(angle), parts) + 1j * np.bincount(part, np.sin(angle), parts)
    steps = np.angle(facing[1:] * np.conj(facing[:-1]))
    return float(steps.sum()) if np.abs(steps).sum() <= 1.2 * abs(steps.sum()) else 0.0
