"""Angle correction files of single Hesai sensors: CSV with channel, elevation and azimuth offset in degrees."""
from __future__ import annotations

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
