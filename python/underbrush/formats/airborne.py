"""Positions of an airborne scanner, estimated from the points of a survey file."""
from __future__ import annotations

import dataclasses

import numpy as np

from ..errors import FormatError
from ._files import OptionMissing, with_thousands
from .flight_line import Floats, Solution, solved
from .pulses import COUNT, PulseTable
from .scans import Poses, Survey

_LEAST_HEIGHT_M, _GREATEST_HEIGHT_M = 20.0, 12e3
_AFTER_S = 1e-6  # So that the last point lies before the last node.
_WORST_FLAT, _WORST_UP = 0.1, 0.2  # Of the height: standard errors beyond which an estimate is of no use.


@dataclasses.dataclass
class FlightLine:
    """The estimate of a flight line; `reason` is why there is none."""

    found: Solution
    points: int
    reason: str


@dataclasses.dataclass
class Estimate:
    """The estimates of a file's flight lines."""

    lines: list[FlightLine]
    poses: Poses  #: Positions by time, without rotations; NaN on flight lines that have no estimate.

    def note(self) -> str:
        """One line: from what the positions were estimated, and how well."""
        good = [line.found for line in self.lines if not line.reason]
        sigma = [np.sqrt(np.mean(one.sigma**2, axis=0)) for one in good]
        flat, up = max(float(np.hypot(s[0], s[1])) for s in sigma), max(float(s[2]) for s in sigma)
        pulses, heights = sum(one.pulses for one in good), [one.height_m for one in good]
        sources = [f"{with_thousands(pulses)} pulses with several returns"] * bool(pulses)
        sources += ["the scan angles"] * any(one.angles for one in good)
        several = len(good) > 1
        text = (f"the sensor's positions are estimated from {' and '.join(sources)}: {len(good)} flight "
                f"line{'s' * several}, {min(heights):.0f}{f' to {max(heights):.0f}' * several} m above the ground, "
                f"1-sigma {flat:.2g} m horizontally and {up:.2g} m vertically{' on the worst' * several} "
                "(--poses FILE gives the true ones)")
        if lost := [line for line in self.lines if line.reason]:
            text += (f"; {with_thousands(sum(line.points for line in lost))} points of {len(lost)} other flight "
                     f"line{'s' * (len(lost) > 1)} are left out, because {lost[0].reason}")
        return text


def estimate_poses(recording: Survey) -> Estimate:
    """Reads a survey file once to estimate where its sensor was, and sets its poses and the note on them.

    Raises `OptionMissing` if the positions do not follow from the points, `FormatError` if there are no points.
    """
    table, skipped = PulseTable(), recording.skipped.copy()
    timed = True
    for scan in recording.scans():
        timed = scan.beam_time_s is not None
        if not timed:
            break
        table.add(scan)
    recording.skipped.clear()  # The next reading counts again.
    recording.skipped.update(skipped)
    if timed and not table.points:
        raise FormatError(recording.path, "", "no points in it")
    found = _estimate(table) if timed else "its points have no times"
    if isinstance(found, str):
        options = "--poses FILE (GPS time x y z) or, for a tripod, " * timed + "--position X,Y,Z"
        raise OptionMissing(f"{recording.path}: the sensor's positions are not in it and cannot be estimated, because "
                            f"{found}: add {options}")
    recording.poses, recording.estimated = found.poses, found.note()
    return found


def _estimate(table: PulseTable) -> Estimate | str:
    """The estimate from what was collected, or why there is none."""
    if not table.multiple and not table.has_angles:
        return "its pulses have single returns only and no scan angles"
    lines = []
    for pulses, cells in table.lines():
        found = solved(pulses, cells, table.whole_angles)
        found.time_s += table.start_s
        found.time_s[-1] += _AFTER_S
        found.position += table.origin
        lines.append(FlightLine(found, int(cells[:, COUNT].sum()), found.reason or _judged(found)))
    if all(line.reason for line in lines):
        return max(lines, key=lambda line: line.points).reason
    time = np.concatenate([line.found.time_s for line in lines])
    place = np.concatenate([line.found.position * (np.nan if line.reason else 1) for line in lines])
    return Estimate(lines, Poses(time, place, np.tile([0.0, 0.0, 0.0, 1.0], (len(time), 1))))


def _judged(found: Solution) -> str:
    """Why an estimate is of no use; empty where it is."""
    height = found.height_m
    if not _LEAST_HEIGHT_M < height < _GREATEST_HEIGHT_M:
        return f"its pulses meet {height:.0f} m above the ground, where no aircraft flies"
    sigma: Floats = np.sqrt(np.mean(found.sigma**2, axis=0))
    if np.hypot(sigma[0], sigma[1]) > _WORST_FLAT * height or sigma[2] > _WORST_UP * height:
        return (f"its {found.pulses} pulses with several returns and its scan angles place the sensor only to "
                f"{np.hypot(sigma[0], sigma[1]):.0f} m horizontally and {sigma[2]:.0f} m vertically")
    return ""
