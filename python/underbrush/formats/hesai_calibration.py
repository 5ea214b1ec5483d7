"""Files of single Hesai sensors: angle corrections and the firing times of their channels, both CSV.

Sources: the maker's manuals and its driver HesaiLidar_SDK_2.0.
"""
from __future__ import annotations

import dataclasses
import pathlib

import numpy as np
import numpy.typing as npt

from underbrush.errors import FormatError

Floats = npt.NDArray[np.float64]

_MOST_CHANNELS = 256


def read_angles(path: str | pathlib.Path) -> tuple[Floats, Floats]:
    """Elevations and azimuth offsets (clockwise), rad, of the channels in order. Raises OSError, FormatError.

    Lines of another number of columns (titles, a check sum) are passed over.
    """
    text = pathlib.Path(path).read_text(encoding="utf-8-sig", errors="replace")
    rows: list[tuple[float, float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split(",")
        if len(words) != 3 or not words[0].strip().isdecimal():
            continue
        try:
            elevation, azimuth = float(words[1]), float(words[2])
        except ValueError:
            elevation = np.nan
        if int(words[0]) != len(rows) + 1 or len(rows) == _MOST_CHANNELS:
            raise FormatError(path, f"line {number}", f"channel {len(rows) + 1} was expected here")
        if not (abs(elevation) <= 90 and abs(azimuth) <= 360):
            raise FormatError(path, f"line {number}", "expected a channel's elevation and azimuth in degrees")
        rows.append((elevation, azimuth))
    if not rows:
        raise FormatError(path, "", "is no angle correction file of a Hesai (CSV: channel, elevation, azimuth)")
    angles = np.radians(np.array(rows))
    return angles[:, 0], angles[:, 1]


@dataclasses.dataclass(frozen=True)
class FiringTimes:
    """When the channels fire. A firing is in one of several states, in each of which some of the channels fire."""

    kind: str  #: "loops" (QT128), "states" (Pandar128) or "states, OT128".
    us: Floats  #: (states, channels), µs after the start of the firing; NaN where the channel does not fire.


def read_times(path: str | pathlib.Path) -> FiringTimes:
    """Reads a file of firing times. Raises OSError, FormatError."""
    text = pathlib.Path(path).read_text(encoding="utf-8-sig", errors="replace")
    lines = [[word.strip() for word in line.split(",")] for line in text.splitlines() if line.strip()]
    try:
        if lines[0][0].lower() == "eeff":
            return FiringTimes("loops", _loops(lines))
        if lines[0][0] == "Operational State":
            return FiringTimes("states, OT128", _states(lines[2:], 1, 1.0))
        if lines[1][0].lower() == "operation mode":
            return FiringTimes("states", _states(lines[3:], 2, 0.001))
    except (ValueError, IndexError) as error:
        raise FormatError(path, "", f"is no file of firing times of a Hesai: {error}") from error
    raise FormatError(path, "line 1", "is no file of firing times of a Hesai QT128, Pandar128 or OT128 (CSV)")


def _loops(lines: list[list[str]]) -> Floats:
    """A line for each shot, with channel and time (µs) in each loop; a channel 0 fills a shorter loop."""
    loops = int(lines[1][3])
    if not 1 <= loops <= 4:
        raise ValueError(f"{loops} loops; 1 to 4 are possible")
    out = np.full((loops, _MOST_CHANNELS), np.nan)
    for words in lines[3:]:
        if len(words) != 2 * loops:
            continue  # The check sum.
        for loop in range(loops):
            channel, time_us = int(words[2 * loop]), float(words[2 * loop + 1])
            if not (0 <= channel <= _MOST_CHANNELS and 0 <= time_us < 1000):
                raise ValueError(f"channel {channel} at {time_us} µs")
            if channel:
                out[loop, channel - 1] = time_us
    return _up_to_last(out)


def _states(lines: list[list[str]], step: int, unit_us: float) -> Floats:
    """A line for each channel, with a time for each state; "-" where it does not fire.

    With a `step` of 2, a state has two columns: for targets beyond some distance, which is taken, and for nearer ones;
    and 0 stands where it does not fire.
    """
    rows: list[list[float]] = []
    for words in lines:
        if not words[0].isdecimal():
            continue  # The check sum.
        if int(words[0]) != len(rows) + 1 or len(rows) == _MOST_CHANNELS:
            raise ValueError(f"channel {len(rows) + 1} was expected instead of {words[0]}")
        times = [np.nan if word == "-" else float(word) * unit_us for word in words[1::step]]
        if not all(np.isnan(time) or 0 <= time < 1000 for time in times):
            raise ValueError(f"channel {words[0]} has a time beyond 0 to 1000 µs")
        rows.append([np.nan if time == 0 and step == 2 else time for time in times])
    out = np.array(rows).T
    if out.ndim != 2 or out.shape[0] < 6:
        raise ValueError("fewer than six states")
    return out


def _up_to_last(times: Floats) -> Floats:
    """Without the channels behind the last one that fires."""
    fire = ~np.isnan(times).all(axis=0)
    if not fire.any():
        raise ValueError("no channel fires")
    return times[:, :int(np.flatnonzero(fire)[-1]) + 1]


def files_of(path: pathlib.Path) -> tuple[pathlib.Path, pathlib.Path | None]:
    """The file of angles and that of firing times: `path` and None, or those of a folder. Raises OSError, FormatError."""
    if not path.is_dir():
        return path, None
    angles, times = [], []
    for file in sorted(path.glob("*.csv")):
        try:
            read_times(file)
            times.append(file)
        except FormatError:
            try:
                read_angles(file)
                angles.append(file)
            except FormatError:
                pass
    if len(angles) != 1 or len(times) > 1:
        raise FormatError(path, "", f"has {len(angles)} files of angles and {len(times)} of firing times of a Hesai; "
                          "put one of each into a folder")
    return angles[0], times[0] if times else None
