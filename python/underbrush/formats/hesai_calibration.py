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

    Lines of another number of columns (titles, a check sum) are skipped.
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


_MODE_HEAD = [mode for mode, states in (("0", 4), ("2", 2), ("3", 2)) for _ in range(states)]
_STATE_HEAD = ["0", "1", "2", "3", "0", "1", "0", "1"]


def _lines_of(path: pathlib.Path) -> list[list[str]]:
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    return [[word.strip() for word in line.split(",")] for line in text.splitlines() if line.strip()]


def _kind_of(lines: list[list[str]]) -> str:
    """The kind of firing times by the first lines; empty for other files."""
    if len(lines) > 1 and lines[0][0].lower() == "eeff" and "LoopNum" in lines[1]:
        return "loops"
    if lines and lines[0][0] == "Operational State":
        return "states, OT128"
    return "states" if len(lines) > 1 and lines[1][0].lower() == "operation mode" else ""


def read_times(path: pathlib.Path) -> FiringTimes | None:
    """Reads a file of firing times; None for a file of something else. Raises OSError, FormatError."""
    lines = _lines_of(path)
    kind = _kind_of(lines)
    try:
        if kind == "loops":
            return FiringTimes(kind, _loops(lines))
        if kind == "states, OT128":
            return FiringTimes(kind, _states(lines[0], lines[1], lines[2:], 1, 1.0))
        return FiringTimes(kind, _states(lines[1], lines[2], lines[3:], 2, 0.001)) if kind else None
    except (ValueError, IndexError) as error:
        raise FormatError(path, "", f"is no file of firing times of a Hesai: {error}") from error


def _loops(lines: list[list[str]]) -> Floats:
    """(loops, channels) µs, of a line for each shot: channel and time in each loop; a channel 0 fills a shorter loop."""
    if lines[1][2] != "LoopNum" or not lines[1][3].isdecimal() or not 1 <= int(lines[1][3]) <= 4:
        raise ValueError("the second line names no 1 to 4 loops")
    loops = int(lines[1][3])
    out = np.full((loops, _MOST_CHANNELS), np.nan)
    for words in lines[3:]:
        if len(words) == 1:
            continue  # The check sum.
        if len(words) != 2 * loops:
            raise ValueError(f"a line of {len(words)} words where {2 * loops} were expected")
        for loop in range(loops):
            channel, time_us = int(words[2 * loop]), float(words[2 * loop + 1])
            if not (0 <= channel <= _MOST_CHANNELS and 0 <= time_us < 1000):
                raise ValueError(f"channel {channel} at {time_us} µs")
            if channel and not np.isnan(out[loop, channel - 1]):
                raise ValueError(f"channel {channel} fires twice in loop {loop + 1}")
            if channel:
                out[loop, channel - 1] = time_us
    return _checked(out[:, :int(np.flatnonzero(~np.isnan(out).all(axis=0)).max(initial=0)) + 1])


def _states(modes: list[str], states: list[str], lines: list[list[str]], step: int, unit_us: float) -> Floats:
    """(states, channels) µs, of a line for each channel with a time for each state; "-" where it does not fire.

    With a `step` of 2, a state has two columns: for targets beyond some distance, which is taken, and for nearer ones,
    whose times are up to 1.3 µs later; and 0 stands where the channel does not fire.
    """
    count = len(modes[1::step])
    if count < 6 or modes[1::step] != _MODE_HEAD[:count] or states[1::step] != _STATE_HEAD[:count]:
        raise ValueError("the columns are not those of the modes 0, 2 and 3 with their states")
    rows: list[list[float]] = []
    for words in lines:
        if len(words) == 1:
            continue  # The check sum.
        if words[0] != str(len(rows) + 1) or len(rows) == _MOST_CHANNELS:
            raise ValueError(f"channel {len(rows) + 1} was expected instead of {words[0]}")
        if len(words[1::step]) != count:
            raise ValueError(f"channel {words[0]} has not a time for each of {count} states")
        times = [np.nan if word == "-" else float(word) * unit_us for word in words[1::step]]
        if not all(np.isnan(time) or 0 <= time < 1000 for time in times):
            raise ValueError(f"channel {words[0]} has a time beyond 0 to 1000 µs")
        rows.append([np.nan if time == 0 and step == 2 else time for time in times])
    return _checked(np.array(rows).reshape(-1, count).T)


def _checked(times: Floats) -> Floats:
    """The times, in each of whose states some channel must fire."""
    idle = np.flatnonzero(np.isnan(times).all(axis=1))
    if len(idle):
        raise ValueError(f"no channel fires in state {idle[0]}")
    return times


def read_unit(path: pathlib.Path) -> tuple[pathlib.Path, FiringTimes | None]:
    """The file of angles and the firing times: `path` and None, or those of a folder. Raises OSError, FormatError."""
    if not path.exists():
        raise FormatError(path, "", "no such file or folder")
    if not path.is_dir():
        return path, None
    angles: list[pathlib.Path] = []
    times: list[FiringTimes] = []
    for file in sorted(path.iterdir()):
        if file.suffix.lower() != ".csv" or not file.is_file():
            continue
        found = read_times(file)
        if found is not None:
            times.append(found)
        elif any("elevation" in word.lower() for line in _lines_of(file)[:2] for word in line):
            angles.append(file)
    if len(angles) != 1 or len(times) > 1:
        raise FormatError(path, "", f"has {len(angles)} files of angles and {len(times)} of firing times of a Hesai (CSV); "
                          "put one of each into a folder")
    return angles[0], times[0] if times else None
