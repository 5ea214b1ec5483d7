"""Angles of Hesai's AT128, whose lasers stand still behind a mirror of several faces, from its binary correction file.

Sources: those of `hesai_packets`.
"""
from __future__ import annotations

import dataclasses
import pathlib

import numpy as np
import numpy.typing as npt

from underbrush.errors import FormatError

Floats = npt.NDArray[np.float64]

_HEAD_BYTES, _STEPS, _STEP_DEG = 16, 180, 2.0  #: Corrections stand for every second degree of the mirror.
_UNIT_DEG = 1 / 25600
_GAP_S = 0.05  #: A scan ends where no block comes for so long; a sweep takes 0.05 s.


@dataclasses.dataclass(frozen=True)
class MirrorAngles:
    """Directions of the lasers by the mirror's azimuth. A face of the mirror begins at each of `start_deg`."""

    start_deg: Floats  #: (faces,)
    azimuth_deg: Floats  #: (lasers,), counter-clockwise.
    elevation_deg: Floats  #: (lasers,)
    azimuth_step_deg: Floats  #: (lasers, steps + 1), clockwise corrections by the mirror's azimuth.
    elevation_step_deg: Floats  #: (lasers, steps + 1)
    has_ranges = False

    @classmethod
    def read(cls, path: str | pathlib.Path, order: npt.NDArray[np.intp]) -> MirrorAngles:
        """Reads a file of version 1.5, whose lasers are put in that order. Raises OSError, FormatError."""
        data = pathlib.Path(path).read_bytes()
        lasers, faces, unit_deg = data[4:5], data[5:6], data[15:16]
        if data[:2] != b"\xee\xff" or lasers != bytes([len(order)]) or not faces or not 1 <= faces[0] <= 8:
            raise FormatError(path, "", "is no angle correction file of a Hesai AT128")
        if data[2:4] != b"\x01\x05":
            raise FormatError(path, "byte 2", f"has version {data[2]}.{data[3]}, but only 1.5 is read")
        n, count = len(order), faces[0]
        table = np.dtype([("start", "<u4", (count,)), ("end", "<u4", (count,)), ("azimuth", "<i4", (n,)),
                          ("elevation", "<i4", (n,)), ("azimuths", "i1", (n, _STEPS)), ("elevations", "i1", (n, _STEPS))])
        if len(data) < _HEAD_BYTES + table.itemsize:
            raise FormatError(path, f"byte {len(data)}", "ends within its tables")
        row = np.frombuffer(data, table, 1, _HEAD_BYTES)[0]
        unit = unit_deg[0] * _UNIT_DEG
        start, azimuth, elevation = row["start"] * unit, row["azimuth"] * unit, row["elevation"] * unit
        if not ((start < 360).all() and (np.diff(np.sort(start)) > 10).all() and (np.abs(azimuth) < 180).all()
                and (np.abs(elevation) <= 90).all()):
            raise FormatError(path, f"byte {_HEAD_BYTES}", "has angles that are no sound numbers")
        # Tables are in 0.01 degrees, and those of 360 and of 0 degrees are the same.
        steps = [np.concatenate([row[name], row[name][:, :1]], axis=1)[order] * (unit_deg[0] * 0.01)
                 for name in ("azimuths", "elevations")]
        return cls(start, azimuth[order], elevation[order], *steps)

    def beams(self, azimuth: Floats) -> tuple[Floats, None]:
        """Directions (n, 3) of firings at (firings, lasers) azimuths of the mirror (rad, counter-clockwise)."""
        mirror = np.degrees(-azimuth) % 360
        begin, part = np.divmod(mirror / _STEP_DEG, 1)
        step, laser = begin.astype(np.int64) % _STEPS, np.arange(mirror.shape[1])

        def between(table: Floats) -> Floats:
            values: Floats = table[laser, step] * (1 - part) + table[laser, step + 1] * part
            return values

        since = np.min((mirror[..., None] - self.start_deg) % 360, axis=-1)  # The face began last.
        clockwise = np.radians(2 * since - self.azimuth_deg + between(self.azimuth_step_deg))
        elevation = np.radians(self.elevation_deg + between(self.elevation_step_deg))
        direction = np.stack([np.sin(clockwise) * np.cos(elevation), np.cos(clockwise) * np.cos(elevation),
                              np.sin(elevation)], axis=-1)
        return direction.reshape(-1, 3), None

    def corrected(self, direction: Floats, range_m: npt.NDArray[np.float32], laser: npt.NDArray[np.int64]) -> tuple[
            Floats, npt.NDArray[np.float32]]:
        """Directions and ranges as they are."""
        return direction, range_m


class Sweeps:
    """Counts the sweeps of the mirror's faces, each of which is a scan."""

    def __init__(self, start_deg: Floats) -> None:
        self._start_deg = start_deg
        self._last: tuple[int, float, float] | None = None  # Face, time (s) and number of the sweep.

    def advance(self, azimuth_deg: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """Rate of the lasers' azimuths in a firing (0) and number of the sweep, (n,), as `Rotation.advance`."""
        if not len(time_s):
            return np.zeros(0), np.zeros(0)
        face = np.argmin((azimuth_deg[:, None] - self._start_deg) % 360, axis=1)
        last = self._last or (int(face[0]), float(time_s[0]), 0.0)
        other = np.diff(face, prepend=last[0]) != 0
        other |= np.abs(np.diff(time_s, prepend=last[1])) > _GAP_S
        turn = last[2] + np.cumsum(other)
        self._last = (int(face[-1]), float(time_s[-1]), float(turn[-1]))
        return np.zeros(len(time_s)), turn
