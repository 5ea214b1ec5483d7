"""The table of driver layouts: how lidar drivers lay out the points of their clouds.

Readers and writers of point clouds use the same table. The offsets are the drivers' own, so that a cloud written
here is the driver's to the byte.
"""
from __future__ import annotations

import collections
import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._files import Array
from .point_times import PointTimes
from .scans import Scan

Floats = npt.NDArray[np.float64]

_LONGEST_OFFSET_S = 100.0  # A larger time is not an offset within a scan but absolute.


@dataclasses.dataclass(frozen=True)
class Layout:
    """The points of one driver."""

    name: str
    dtype: np.dtype[Any]  #: Fields at the driver's offsets; the item size is the cloud's point step.
    time: str  #: The field of times.
    unit_s: float  #: Unit of that field, s.
    absolute: bool  #: Whether these times are absolute, or count from the message's stamp.
    miss: float | None  #: x, y, z of a miss in an organised cloud; None where the driver drops misses.
    rows: str = "ring"  #: A row of an organised cloud is a "ring" or a "firing".


def _packed(fields: str) -> np.dtype[Any]:
    return np.dtype([(word.split(":")[0], "<" + word.split(":")[1]) for word in fields.split()])


_XYZ = "x:f4 y:f4 z:f4 "
#: velodyne_pointcloud, ouster_ros (PCL's alignment), HesaiLidar_ROS_2.0, livox_ros_driver2, Autoware's XYZIRCAEDT.
LAYOUTS = {layout.name: layout for layout in (
    Layout("velodyne", _packed(_XYZ + "intensity:f4 ring:u2 time:f4"), "time", 1, False, np.nan, "firing"),
    Layout("ouster", np.dtype({
        "names": ["x", "y", "z", "intensity", "t", "reflectivity", "ring", "ambient", "range"],
        "formats": ["<f4", "<f4", "<f4", "<f4", "<u4", "<u2", "<u2", "<u2", "<u4"],
        "offsets": [0, 4, 8, 16, 20, 24, 26, 28, 32], "itemsize": 48}), "t", 1e-9, False, 0.0),
    Layout("hesai", _packed(_XYZ + "intensity:f4 ring:u2 timestamp:f8"), "timestamp", 1, True, None),
    Layout("livox", _packed(_XYZ + "intensity:f4 tag:u1 line:u1 timestamp:f8"), "timestamp", 1e-9, True, None),
    Layout("autoware", _packed(_XYZ + "intensity:u1 return_type:u1 channel:u2 azimuth:f4 elevation:f4 distance:f4 "
                               "time_stamp:u4"), "time_stamp", 1e-9, False, None),
)}

_TIMES = tuple(name + unit for unit in ("", "_ns", "_us", "_ms", "_s") for name in (
    "t", "time", "timestamp", "time_stamp", "stamp", "time_offset", "timeoffset", "offset_time", "offsettime",
    "adjustedtime", "gps_time", "gpstime", "ts", "timestamps", "dt", "point_time", "rel_time"))
_RINGS = ("ring", "channel", "laser_id", "line", "row")
_INTENSITIES = ("intensity", "i", "remission", "signal", "reflectivity")
_DERIVED = ("range", "azimuth", "elevation", "distance")  # These follow from x y z.

#: Rings, lowest and highest elevation (degrees) of the sensors of the catalogue, by layout.
_SENSORS = {
    "velodyne": ((16, -15, 15, "vlp16"), (32, -30.7, 10.7, "hdl32e"), (32, -25, 15, "vlp32c"),
                 (64, -24.9, 2.1, "hdl64e"), (128, -25, 15, "vls128")),
    "ouster": ((64, -16.7, 16.7, "os1-64"), (128, -11.3, 11.3, "os2-128"), (128, -22.7, 22.7, "os1-128"),
               (128, -46, 46, "os0-128")),
    "hesai": ((32, -16, 15, "xt32"), (64, -25, 15, "pandar64"), (128, -12.6, 13.1, "at128")),
    "livox": ((4, -7.3, 52.6, "mid360"), (6, -38.7, 38.7, "avia")),
}


def layout_of(names: tuple[str, ...]) -> str:
    """The driver whose fields these are; "generic" where no layout has just these names of times and rings."""
    for name, mark in (("livox", {"tag", "line"}), ("ouster", {"t", "ring"}), ("autoware", {"time_stamp", "channel"}),
                       ("hesai", {"timestamp", "ring"}), ("velodyne", {"time", "ring"})):
        if mark <= set(names):
            return name
    return "generic"


def _plain(name: str) -> str:
    """A field's name in small letters, without CloudCompare's prefix."""
    return name.lower().removeprefix("scalar_")


def guess_sensor(layout: str, scan: Scan) -> str:
    """Name in the sensor catalogue, from the number of rings and the elevations; empty where none fits."""
    if scan.xyz is None or scan.ring is None or layout not in _SENSORS:
        return ""
    hit = scan.xyz[np.isfinite(scan.xyz[:, 0])]
    rings = int(scan.ring.max(initial=0)) + 1
    if not len(hit):
        return ""
    elevation = np.rad2deg(np.arctan2(hit[:, 2], np.hypot(hit[:, 0], hit[:, 1])))
    low, high = float(elevation.min()), float(elevation.max())
    fits = [(top - bottom, name) for count, bottom, top, name in _SENSORS[layout]
            if count == rings and bottom - 1.5 < low and high < top + 1.5]
    return f"{layout}-{min(fits)[1]}" if fits else ""


def times_of(column: Array, name: str, layout: str, stamp_s: float, others: PointTimes) -> Floats:
    """Absolute times (s) of a column of times.

    A driver's own column of the table's type has the table's unit, if that fits; otherwise `others` finds the unit.
    """
    known = LAYOUTS.get(layout)
    own = known is not None and known.time == name and known.dtype[name].kind == column.dtype.kind
    absolute = known is not None and own and known.absolute and abs(stamp_s) <= 10 * _LONGEST_OFFSET_S
    return others.seconds(name, column, 0.0 if absolute else stamp_s, known.unit_s if known is not None and own else 0)


def scan_from_points(points: npt.NDArray[np.void], stamp_s: float, number: int,
                     skipped: collections.Counter[str], times: PointTimes | None = None) -> tuple[Scan, str]:
    """A scan from the structured array (rows, columns) of a cloud, and the name of its layout.

    Points that are not finite or (0, 0, 0) are misses where the cloud is organised; elsewhere their direction cannot be
    determined, and they are left out and counted. `times` has the unit of the recording's times. `ValueError` without
    x, y, z.
    """
    own = points.dtype.names or ()
    names = {_plain(name): name for name in own}
    names.update({name: name for name in own if name == _plain(name)})
    layout = layout_of(tuple(names))
    shape = (points.shape[0], points.shape[1])
    flat = points.reshape(-1)
    if not {"x", "y", "z"} <= set(names):
        raise ValueError(f"no fields x, y, z, but {', '.join(own) or 'none'}")
    xyz = np.empty((len(flat), 3))
    for axis, name in enumerate("xyz"):
        xyz[:, axis] = flat[names[name]]
    with np.errstate(over="ignore", invalid="ignore"):
        square = np.einsum("ij,ij->i", xyz, xyz)
    hit = (square > 1e-12) & (square < 1e12)
    organised = shape[0] > 1
    if organised:
        xyz[~hit] = np.nan
    elif not hit.all():
        skipped["points without coordinates in a cloud that is not organised"] += int(np.count_nonzero(~hit))
        xyz, flat, hit = xyz[hit], flat[hit], hit[hit]
    scan = Scan(number, stamp_s, xyz=xyz, shape=shape if organised else None)
    used = {names[name] for name in ("x", "y", "z", *_DERIVED) if name in names}
    timed = [name for name in _TIMES if name in names]
    for name in [name for name in timed if len(flat) and np.any(flat[names[name]] != flat[names[name]][0])] or timed:
        scan.beam_time_s = times_of(flat[names[name]], name, layout, stamp_s, times or PointTimes("points"))
        used.add(names[name])
        break
    for name in _RINGS:
        if name in names and _are_rings(flat[names[name]]):
            scan.ring = flat[names[name]].astype(np.uint16)
            used.add(names[name])
            break
    for name in _INTENSITIES:
        if name in names:
            value = flat[names[name]].astype(np.float32)
            scan.intensity = np.where(hit & np.isfinite(value), value, np.float32(0))
            used.add(names[name])
            break
    scan.extra = {name: np.ascontiguousarray(flat[name]) for name in own if name not in used}
    if "return_type" in scan.extra and scan.beam_time_s is not None and scan.ring is not None:
        _number_echoes(scan)
    return scan, layout


def _are_rings(column: Array) -> bool:
    """Whether a column has whole numbers from 0 to 65535, of whatever type."""
    if column.dtype.kind == "u" and column.dtype.itemsize <= 2:
        return True
    return bool(np.all((column >= 0) & (column <= 65535) & (column == np.floor(column))))


def _number_echoes(scan: Scan) -> None:
    """Joins the returns of equal ring and time to beams, in order of range."""
    assert scan.xyz is not None and scan.beam_time_s is not None and scan.ring is not None
    distance = np.linalg.norm(scan.xyz, axis=1)
    order = np.lexsort((distance, scan.ring, scan.beam_time_s))
    begins = np.ones(len(order), bool)
    begins[1:] = (np.diff(scan.beam_time_s[order]) > 0) | (np.diff(scan.ring[order].astype(np.int32)) != 0)
    number, count = ranks(begins)
    take_rows(scan, order)
    scan.echo, scan.echoes = number, count
    assert scan.xyz is not None
    miss = np.isnan(scan.xyz[:, 0])
    scan.echo[miss], scan.echoes[miss] = 0, 0


def ranks(begins: npt.NDArray[np.bool_]) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """Number of each row in its beam (1, 2, …) and the rows of its beam, from the rows that begin a beam."""
    if begins.all():
        return np.ones(len(begins), np.uint8), np.ones(len(begins), np.uint8)
    starts = np.flatnonzero(begins)
    count = np.diff(np.append(starts, len(begins)))
    number = np.arange(len(begins)) - np.repeat(starts, count) + 1
    return np.minimum(number, 255).astype(np.uint8), np.minimum(np.repeat(count, count), 255).astype(np.uint8)


def take_rows(scan: Scan, rows: npt.NDArray[Any]) -> None:
    """Keeps these rows of all columns, in this order."""
    for name in ("xyz", "direction", "range_m", "origin", "beam_time_s", "intensity", "ring", "echo", "echoes"):
        column = getattr(scan, name)
        if column is not None:
            setattr(scan, name, column[rows])
    scan.extra = {name: column[rows] for name, column in scan.extra.items()}
    scan.shape = None


def points_from_columns(layout: Layout, columns: Mapping[str, Array], stamp_s: float,
                        lost: collections.Counter[str]) -> npt.NDArray[np.void]:
    """Structured array of a driver's points from columns: xyz (n, 3), intensity, ring, time_s, range_m; misses are
    rows with an infinite range.

    Further fields come from columns of their names, else 0. Values that a field cannot hold are clamped and counted.
    """
    xyz, range_m = np.asarray(columns["xyz"], np.float64), np.asarray(columns["range_m"], np.float64)
    hit = np.isfinite(range_m)
    x, y, z = xyz.T
    time = np.asarray(columns["time_s"], np.float64) - (0.0 if layout.absolute else stamp_s)
    zero = np.zeros(len(xyz))
    value: dict[str, Array] = {
        "intensity": columns["intensity"], "reflectivity": columns["intensity"],
        "ring": columns["ring"], "channel": columns["ring"], "line": columns["ring"],
        "range": np.where(hit, range_m, 0) * 1e3, "distance": np.where(hit, range_m, 0),
        "azimuth": np.where(hit, np.arctan2(y, x), 0), "elevation": np.where(hit, np.arctan2(z, np.hypot(x, y)), 0),
        layout.time: time / layout.unit_s}
    for axis, name in enumerate("xyz"):
        value[name] = np.where(hit, xyz[:, axis], 0.0 if layout.miss is None else layout.miss)
    points = np.zeros(len(xyz), layout.dtype)
    for name in layout.dtype.names or ():
        column = value[name] if name in value and name not in columns else columns.get(name, zero)
        points[name] = _held(np.asarray(value.get(name, column) if name in "xyz" else column), layout.dtype[name],
                             name, lost)
    return points


def _held(values: Array, dtype: np.dtype[Any], name: str, lost: collections.Counter[str]) -> Array:
    """Values as that type: rounded and clamped to its range; what was clamped is counted."""
    if dtype.kind not in "iu":
        return values.astype(dtype)
    limits = np.iinfo(dtype)
    whole = np.rint(values.astype(np.float64))
    clamped = (whole < limits.min) | (whole > limits.max) | ~np.isfinite(whole)
    if clamped.any():
        lost[f"values of {name} beyond {limits.max} (clamped)"] += int(np.count_nonzero(clamped))
    return np.asarray(np.clip(np.nan_to_num(whole), limits.min, limits.max).astype(dtype))
