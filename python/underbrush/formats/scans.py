"""Scans as all readers of recordings yield them."""
from __future__ import annotations

import collections
import dataclasses
import functools
import pathlib
from collections.abc import Iterable, Iterator
from typing import Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.generic]

#: The message for a recording without poses.
NO_POSES = ("no poses in it: add --poses FILE (t x y z qx qy qz qw, world from sensor) or, for a sensor that stands still, "
            "--position X,Y,Z")
_FAR_M, _EXTENT, _ENOUGH = 300.0, 0.3, 20  # m; of the distance; points.


@dataclasses.dataclass
class Scan:
    """One revolution or frame in the sensor's frame (x forward, y left, z up; m), a row for each return or miss.

    A scan has either points (`xyz`, a miss is NaN and needs `shape` so that its direction can be found) or beams
    (`direction` and `range_m`, a miss has the range infinity). All columns have the same length n.
    """

    number: int  #: Number of the scan in its recording.
    time_s: float  #: Reference time, s.
    xyz: npt.NDArray[np.float64] | None = None  #: (n, 3), m.
    direction: npt.NDArray[np.float64] | None = None  #: (n, 3), unit vectors.
    range_m: npt.NDArray[np.float32] | None = None  #: (n,), m, from `origin`; infinity is a miss.
    origin: npt.NDArray[np.float64] | None = None  #: (n, 3), m, where beams do not start at the sensor's origin.
    beam_time_s: npt.NDArray[np.float64] | None = None  #: (n,), s, absolute; None where the format has no times.
    intensity: npt.NDArray[np.float32] | None = None  #: (n,), in the sensor's unit; 0 for a miss.
    ring: npt.NDArray[np.uint16] | None = None  #: (n,), channel, numbered from 0 in the sensor's own order.
    echo: npt.NDArray[np.uint8] | None = None  #: (n,), number of the return in order of range, 1, 2, …; 0 for a miss.
    echoes: npt.NDArray[np.uint8] | None = None  #: (n,), number of returns of the row's beam.
    shape: tuple[int, int] | None = None  #: (rows, columns) of an organised scan, stored row by row.
    extra: dict[str, Array] = dataclasses.field(default_factory=dict)  #: Further columns of n entries by name.

    def __len__(self) -> int:
        column = self.xyz if self.xyz is not None else self.range_m
        return 0 if column is None else len(column)


@dataclasses.dataclass
class Poses:
    """Poses of a sensor along its way, in order of time."""

    time_s: npt.NDArray[np.float64]  #: (m,), s.
    position: npt.NDArray[np.float64]  #: (m, 3), m, world frame.
    rotation: npt.NDArray[np.float64]  #: (m, 4), world from sensor, quaternion x y z w.

    @functools.cached_property
    def gaps(self) -> npt.NDArray[np.float64]:
        """(k, 2) s: where the place of the sensor is not known, by the rule of the program's import. Between two poses
        that are more than 1 s and ten usual steps apart, the sensor moves by more than 0.5 m and three usual ways or
        turns by more than 5° and three usual turns; a usual step at both ends is no part of the gap."""
        if len(self.time_s) < 3:
            return np.zeros((0, 2))
        step, way = np.diff(self.time_s), np.linalg.norm(np.diff(self.position, axis=0), axis=1)
        cosine = np.abs((self.rotation[1:] * self.rotation[:-1]).sum(axis=1))
        turn = 2 * np.arccos(np.clip(cosine, 0, 1))
        usual = float(np.median(step))
        moved = (way > max(0.5, 3 * float(np.median(way)))) | (turn > max(np.radians(5), 3 * float(np.median(turn))))
        k = np.flatnonzero((step > max(1.0, 10 * usual)) & moved)
        return np.column_stack([self.time_s[k] + usual, self.time_s[k + 1] - usual])

    def in_gaps(self, time_s: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """(n,), whether a time lies in a gap."""
        gap = np.searchsorted(self.gaps[:, 0], time_s, side="left") - 1
        ends = np.append(self.gaps[:, 1], -np.inf)  # The last one for times before all gaps.
        return np.asarray(time_s < ends[gap], np.bool_)


class Recording(Protocol):
    """What a reader of recordings offers. It reads in bounded memory: one scan at a time."""

    sensor: str  #: Name in the sensor catalogue; empty where unknown.
    crs: str  #: Coordinate reference system as the file gives it (WKT or EPSG:N); empty where there is none.
    poses: Poses | None  #: Poses that the recording itself contains.
    skipped: collections.Counter[str]  #: Records left out so far, by reason.
    bytes_total: int  #: Size of the recording, bytes.
    bytes_done: int  #: Bytes read so far, for progress.

    @property
    def organised(self) -> bool:
        """Whether its scans keep misses."""

    @property
    def world(self) -> bool:
        """Whether `xyz` are world coordinates (survey files), and not the sensor's frame."""

    def found(self) -> list[str]:
        """Lines that describe the recording: topics, sensors, rates, counts, time span."""

    def scans(self) -> Iterator[Scan]:
        """Yields all scans in order. Broken records are counted in `skipped`.

        Raises `underbrush.FormatError` where the file as a whole cannot be read.
        """


class Survey:
    """What readers of survey files share: points in world coordinates, without the places of the sensor."""

    sensor, organised, world = "", False, True
    path: pathlib.Path
    poses: Poses | None = None
    skipped: collections.Counter[str]
    estimated = ""  #: How `poses` were estimated from the points; empty where they were not.
    unit_m: tuple[float, float, float] = (1.0, 1.0, 1.0)  #: Of the file's coordinates; `xyz` are in m.

    def scans(self) -> Iterator[Scan]:
        """As `Recording.scans`."""
        raise NotImplementedError

    def notes(self) -> list[str]:
        """Notes on the beams for the user."""
        return [self.estimated] if self.estimated else []


def middles(scans: Iterable[Scan]) -> npt.NDArray[np.float64]:
    """Times (s) of the middles of scans, between their first beam and their last; without those their own times."""
    return np.array([scan.time_s if scan.beam_time_s is None or not len(scan.beam_time_s)
                     else (np.nanmin(scan.beam_time_s) + np.nanmax(scan.beam_time_s)) / 2 for scan in scans])


def far_from_sensor(points: npt.NDArray[np.float64]) -> bool:
    """Whether points (n, 3) in the sensor's frame are as far away, and as close together, as only those of a world.
    Points without coordinates do not count."""
    some = points[::1 + len(points) // 64]
    if np.any(np.einsum("ij,ij->i", some, some) < _FAR_M**2):
        return False
    points = points[np.isfinite(points[:, 0])]
    if len(points) < _ENOUGH:
        return False
    nearest = float(np.sqrt(np.einsum("ij,ij->i", points, points)).min())
    return nearest > _FAR_M and float(np.linalg.norm(np.ptp(points, axis=0))) < _EXTENT * nearest
