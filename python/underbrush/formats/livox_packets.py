"""Layouts of the point cloud packets of Livox's sensors: those of Livox-SDK (version 5) and of Livox-SDK2 (version 0).

Source: the maker's SDKs and ROS drivers.
"""
from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

Packets = npt.NDArray[Any]  #: Of `Layout.packet`.

_DAY = np.dtype([("year", "u1"), ("month", "u1"), ("day", "u1"), ("hour", "u1"), ("us", "<u4")])  #: us: in the hour.
_OLD = [("version", "u1"), ("source", "V3"), ("status", "<u4"), ("stamp_kind", "u1"), ("kind", "u1"), ("stamp", "<u8")]
_NEW = [("version", "u1"), ("size", "<u2"), ("span", "<u2"), ("points_sent", "<u2"), ("number", "<u2"), ("frame", "u1"),
        ("kind", "u1"), ("stamp_kind", "u1"), ("reserved", "V12"), ("check", "<u4"), ("stamp", "<u8")]
OLD_VERSION, NEW_VERSION = 5, 0
OLD_UTC, OLD_PULSE = 3, 4  #: Stamps of version 5: a day's hour in UTC; time since the last pulse, one a second.
INERTIAL = "packets of the sensor's inertial unit"
_SIZES = np.dtype(_OLD).itemsize, np.dtype(_NEW).itemsize
_MOST_POINTS = 1024


def _flat(returns: int, number: str, tag: bool) -> np.dtype[Any]:
    """Points with Cartesian coordinates for each return."""
    fields: list[Any] = [("xyz", number, (3,)), ("reflectivity", "u1"), *([("tag", "u1")] if tag else [])]
    return np.dtype([("returns", fields, (returns,))])


def _angles(returns: int) -> np.dtype[Any]:
    """Points with zenith angle and azimuth, then the depth of each return."""
    fields: list[Any] = [("depth", "<u4"), ("reflectivity", "u1"), ("tag", "u1")]
    return np.dtype([("zenith", "<u2"), ("azimuth", "<u2"), ("returns", fields, (returns,))])


def _single(tag: bool) -> np.dtype[Any]:
    """Points with depth, zenith angle and azimuth."""
    names, types, places = ["depth", "reflectivity", "tag"], ["<u4", "u1", "u1"], [0, 8, 9]
    size = 9 + tag
    part = np.dtype({"names": names[:2 + tag], "formats": types[:2 + tag], "offsets": places[:2 + tag],
                     "itemsize": size})
    return np.dtype({"names": ["returns", "zenith", "azimuth"], "formats": [(part, (1,)), "<u2", "<u2"],
                     "offsets": [0, 4, 6], "itemsize": size})


#: Kind of data of version 5 -> points in a packet and their type; kind 6 is the inertial unit's.
_OLD_KINDS = {0: (100, _flat(1, "<i4", False)), 1: (100, _single(False)), 2: (96, _flat(1, "<i4", True)),
              3: (96, _single(True)), 4: (48, _flat(2, "<i4", True)), 5: (48, _angles(2)),
              7: (30, _flat(3, "<i4", True)), 8: (30, _angles(3))}
#: The same of version 0, with the unit of lengths, m; kind 0 is the inertial unit's.
_NEW_KINDS = {1: (0.001, _flat(1, "<i4", True)), 2: (0.01, _flat(1, "<i2", True)), 3: (0.001, _single(True)),
              0x11: (0.001, _flat(2, "<i4", True))}
_OLD_INERTIAL, _NEW_INERTIAL = 6, 0


@dataclasses.dataclass(frozen=True)
class Layout:
    """The layout that a packet's header gives."""

    version: int
    kind: int
    points: int

    @property
    def _point(self) -> np.dtype[Any]:
        return _OLD_KINDS[self.kind][1] if self.version == OLD_VERSION else _NEW_KINDS[self.kind][1]

    @property
    def packet(self) -> np.dtype[Any]:
        header: list[Any] = [*(_OLD if self.version == OLD_VERSION else _NEW)]
        return np.dtype([*header, ("points", self._point, (self.points,))])

    @property
    def unit_m(self) -> float:
        return 0.001 if self.version == OLD_VERSION else _NEW_KINDS[self.kind][0]

    @property
    def returns(self) -> int:
        return int(self._point["returns"].shape[0])

    @property
    def is_cartesian(self) -> bool:
        return "zenith" not in (self._point.names or ())


def layout_of(data: bytes) -> Layout | None:
    """The layout of a datagram; None where it is no point cloud of Livox."""
    if len(data) <= _SIZES[0]:
        return None
    if data[0] == OLD_VERSION and data[8] <= OLD_PULSE and data[9] in _OLD_KINDS:
        points, point = _OLD_KINDS[data[9]]
        return Layout(OLD_VERSION, data[9], points) if len(data) == _SIZES[0] + points * point.itemsize else None
    if data[0] == NEW_VERSION and len(data) > _SIZES[1] and data[10] in _NEW_KINDS:
        points = int.from_bytes(data[5:7], "little")
        size = _SIZES[1] + points * _NEW_KINDS[data[10]][1].itemsize
        if 0 < points <= _MOST_POINTS and int.from_bytes(data[1:3], "little") == len(data) == size:
            return Layout(NEW_VERSION, data[10], points)
    return None


def is_inertial(data: bytes) -> bool:
    """Whether a datagram has the measurements of a sensor's inertial unit."""
    return (len(data) == _SIZES[0] + 24 and data[0] == OLD_VERSION and data[9] == _OLD_INERTIAL
            or len(data) == _SIZES[1] + 24 and data[0] == NEW_VERSION and data[10] == _NEW_INERTIAL)


def seconds_of(packets: Packets, version: int) -> npt.NDArray[np.float64]:
    """(n,) stamps, s, as the sensor counts them."""
    seconds: npt.NDArray[np.float64] = packets["stamp"] * 1e-9
    if version == OLD_VERSION:
        day = np.ascontiguousarray(packets["stamp"]).view(_DAY)
        months = (day["year"].astype(np.int64) + 30) * 12 + day["month"] - 1
        days = months.astype("datetime64[M]").astype("datetime64[D]").astype(np.int64) + day["day"] - 1
        utc = (days * 24 + day["hour"]) * 3600 + day["us"] * 1e-6
        seconds = np.where(packets["stamp_kind"] == OLD_UTC, utc, seconds)
    return seconds
