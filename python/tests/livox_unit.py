"""Packets of Livox's sensors, written as the maker's SDKs describe them, with what their beams measured."""
from __future__ import annotations

import dataclasses
import functools
import struct

import numpy as np
import numpy.typing as npt

import packet_files as pf
from packet_files import T0, Floats


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of data of one of the two protocols."""

    version: int
    code: int
    points: int
    returns: int
    form: str  #: mm or cm (Cartesian), angles, or early (angles after the depth).
    has_tag: bool
    step_ns: float  #: Time between points.
    sensor: str = ""


KINDS = {
    "old cartesian": Kind(5, 0, 100, 1, "mm", False, 10_000), "old spherical": Kind(5, 1, 100, 1, "early", False, 10_000),
    "extended cartesian": Kind(5, 2, 96, 1, "mm", True, 1e9 / 240_000),
    "extended spherical": Kind(5, 3, 96, 1, "early", True, 1e9 / 240_000),
    "dual cartesian": Kind(5, 4, 48, 2, "mm", True, 1e9 / 240_000),
    "dual spherical": Kind(5, 5, 48, 2, "angles", True, 1e9 / 240_000),
    "triple cartesian": Kind(5, 7, 30, 3, "mm", True, 1e9 / 240_000, "livox-avia"),
    "triple spherical": Kind(5, 8, 30, 3, "angles", True, 1e9 / 240_000, "livox-avia"),
    "mid360 high": Kind(0, 1, 96, 1, "mm", True, 5000, "livox-mid360"),
    "mid360 low": Kind(0, 2, 96, 1, "cm", True, 5000, "livox-mid360"),
    "mid360 spherical": Kind(0, 3, 96, 1, "early", True, 5000, "livox-mid360"),
    "hap dual": Kind(0, 0x11, 96, 2, "mm", True, 1e9 / 452_000),
}


@dataclasses.dataclass
class Truth:
    """What a sensor in the room sees, a row for each beam."""

    zenith: npt.NDArray[np.int64]  #: (n,), 0.01 degrees.
    azimuth: npt.NDArray[np.int64]
    depth_mm: npt.NDArray[np.int64]  #: (n, returns); 0 is none.
    time_s: Floats

    @functools.cached_property
    def direction(self) -> Floats:
        zenith, azimuth = np.radians(self.zenith * 0.01), np.radians(self.azimuth * 0.01)
        return np.stack([np.sin(zenith) * np.cos(azimuth), np.sin(zenith) * np.sin(azimuth), np.cos(zenith)], -1)


def observe(kind: Kind, packets: int, start_s: float = T0) -> Truth:
    """A rosette through a room: beams above 25 degrees are misses; every third one has returns behind the first."""
    k = np.arange(packets * kind.points)
    zenith = np.round(9000 - 4000 * np.cos(k * 0.0137)).astype(np.int64)
    azimuth = (k * 137) % 36000
    truth = Truth(zenith, azimuth, np.zeros((len(k), kind.returns), np.int64), start_s + k * kind.step_ns * 1e-9)
    near = np.round(pf.room_range(truth.direction) * 1000).astype(np.int64)
    truth.depth_mm[:] = np.where(k % 3 == 0, 1, 0)[:, None] * np.array([700, 0, 1500])[:kind.returns] + near[:, None]
    if kind.returns == 1:
        truth.depth_mm[:, 0] = near
    if kind.returns > 1:
        truth.depth_mm[k % 5 == 1, 0] = 0  # Any may be absent.
    truth.depth_mm[zenith < 6500] = 0
    return truth


def stamp_of(time_s: float, form: int) -> bytes:
    """A stamp: nanoseconds, or (3) a day's hour in UTC with microseconds in it."""
    if form == 3:
        minutes = int(time_s // 3600 * 3600)
        day = np.datetime64(minutes, "s").item()
        return struct.pack("<4BI", day.year - 2000, day.month, day.day, day.hour, round((time_s - minutes) * 1e6))
    return struct.pack("<Q", round(time_s * 1e9))


def point(kind: Kind, truth: Truth, k: int) -> bytes:
    """The bytes of a beam."""
    body = b""
    angles = struct.pack("<HH", truth.zenith[k], truth.azimuth[k])
    for which, depth in enumerate(truth.depth_mm[k].tolist()):
        shade, tag = depth % 200, bytes([which << 4]) if kind.has_tag else b""
        if kind.form in ("mm", "cm"):
            xyz = np.round(truth.direction[k] * depth / (10 if kind.form == "cm" else 1)).astype(int).tolist()
            body += struct.pack("<3i" if kind.form == "mm" else "<3h", *xyz) + bytes([shade]) + tag
        else:
            body += struct.pack("<I", depth) + (angles if kind.form == "early" else b"") + bytes([shade]) + tag
    return (angles if kind.form == "angles" else b"") + body


def packet(kind: Kind, truth: Truth, begin: int, stamp: int = 1) -> bytes:
    """The packet whose first point is `begin`; `stamp` is the kind of its stamp."""
    body = b"".join(point(kind, truth, k) for k in range(begin, begin + kind.points))
    when = stamp_of(float(truth.time_s[begin]), stamp)
    if kind.version == 5:
        return bytes([5, 1, 1, 0]) + b"\0" * 4 + bytes([stamp, kind.code]) + when + body
    head = struct.pack("<HHHHBBB", 36 + len(body), round(kind.points * kind.step_ns / 100), kind.points, begin & 0xFFFF, 0,
                       kind.code, stamp)
    return b"\0" + head + b"\0" * 12 + b"\1\2\3\4" + when + body


def packets_of(name: str, packets: int, truth: Truth | None = None, stamp: int = 1) -> list[tuple[float, bytes]]:
    """Times (s) and data of packets."""
    kind = KINDS[name]
    seen = truth or observe(kind, packets)
    return [(float(seen.time_s[begin]) + 600e-6, packet(kind, seen, begin, stamp))
            for begin in range(0, packets * kind.points, kind.points)]
