"""Between recordings and the library's logs, `underbrush.LogInfo` and `underbrush.BeamLog`."""
from __future__ import annotations

import functools
import importlib
import os
import pathlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..errors import FormatError
from ._files import Array, PathLike
from .bag import BagRecording
from .infer_misses import MissInference
from .numpy_log import NumpyLogWriter
from .place import beams, poses_of
from .scans import Poses, Recording, Scan
from .trajectory import beyond_ends, in_order, pose_at, read_poses
from .write_bag import BagWriter
from .write_las import LasWriter

_NAMED = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags")


def columns_of(log: Any) -> dict[str, Array]:
    """The columns of a `BeamLog` as the writers take them: views, nothing is copied."""
    return {**{name: getattr(log, name) for name in _NAMED}, **log.extra}


def poses_of_scans(info: Any) -> Poses:
    """The poses of a log's scans, and one after the last scan, to which the motion goes on. `ValueError` where the log
    has none."""
    if not info.scans:
        raise ValueError("the log has no poses of its scans: give poses")
    at = [(scan.time_s, scan.world_from_sensor) for scan in info.scans]
    poses = beyond_ends(in_order(np.array([time for time, _ in at]), np.array([pose.position for _, pose in at]),
                                 np.array([pose.rotation for _, pose in at])))
    first = 1 if len(poses.time_s) > 1 else 0
    return Poses(poses.time_s[first:], poses.position[first:], poses.rotation[first:])


def export_log(log: Any, path: PathLike, *, layout: str = "ouster", poses: Poses | PathLike | None = None,
               crs: str = "", compress: bool = False) -> dict[str, int]:
    """Writes a log in the format of the name's extension: `.las`, `.laz`, `.npz`, `.mcap`, `.db3`, `.bag` or a ROS 2
    folder. A file that exists is replaced.

    `log` is a `BeamLog` or the path of one (ray cloud PLY), which is read in chunks. `layout`, `poses` (by default
    those of the log's scans) and `compress` are for ROS (see `BagWriter`), `crs` is for LAS. Returns what the format
    could not hold, counts by reason. Raises `ValueError`, `FormatError`, `OSError`, `ImportError`.
    """
    library: Any = importlib.import_module("underbrush")
    chunks: Any = library.LogReader(log) if isinstance(log, (str, os.PathLike)) else [log]
    info = chunks.info if not isinstance(chunks, list) else log.info
    kind = pathlib.Path(path).suffix.lower()
    writer: Any
    if kind == ".npz":
        writer = NumpyLogWriter(path)
    elif kind in (".las", ".laz"):
        writer = LasWriter(path, crs=crs, element_classes=info.element_classes or library.class_names())
    else:
        known = poses if isinstance(poses, Poses) else read_poses(poses) if poses else poses_of_scans(info)
        writer = BagWriter(path, known, layout=layout, compress=compress)
    with writer:
        for chunk in chunks:
            writer.write(columns_of(chunk))
    return dict(writer.lost)


def beams_of_recording(recording: Recording, *, poses: Poses | PathLike | None = None,
                       position: Sequence[float] | None = None, sensor: str | None = None,
                       infer: MissInference | None = None, frames: range | None = None,
                       keep: tuple[str, float] | None = None) -> tuple[Any, Iterator[Any]]:
    """The facts of a recording as a `LogInfo`, and its beams as `BeamLog`s, one for each scan or piece.

    `poses`, `position`, `infer` and `frames` are as for `beams`; `sensor` is a name of the catalogue or a file, by
    default that of the inferred misses, else the recording's. Of the beams, those are kept whose column `keep[0]` has
    the value `keep[1]`. The first scan is checked against a spinning sensor that is given. The scans' poses stand at
    the head of a log, but for a sensor at a `position`: a ROS recording is read twice, the first time without its
    points. Raises what `beams` raises.
    """
    library: Any = importlib.import_module("underbrush")
    known = poses_of(recording, poses)
    name = sensor or (infer.sensor if infer is not None else recording.sensor)
    limits, found = {}, None
    if name:
        found = library.Sensor(name)
        limits = {"min_range_m": found.min_range_m, "max_range_m": found.max_range_m}
    path = known if position is None else None
    info = library.LogInfo(sensor=name, has_misses=recording.organised or infer is not None, deskewed=True,
                           scans=[one for one in _scan_infos(library, recording, path)
                                  if frames is None or one.scan in frames], **limits)
    if name and pathlib.Path(name).is_file():
        info.sensor, info.sensor_file = found.name, pathlib.Path(name).read_text(encoding="utf-8")
    fits = functools.partial(_fits, recording, found) if sensor and found and found.kind == "spinning" else None
    columns = beams(recording, poses=known, position=position, infer=infer, frames=frames, check=fits)
    return info, (_log(library, info, _kept(recording, one, keep)) for one in columns)


def _fits(recording: Recording, sensor: Any, scan: Scan) -> None:
    """Raises `FormatError` where a scan cannot come from the sensor that a user names."""
    library: Any = importlib.import_module("underbrush._core")
    points = scan.xyz if scan.xyz is not None else scan.direction
    if recording.world or points is None:
        return
    if scan.xyz is None and scan.range_m is not None:
        points = points * np.where(np.isfinite(scan.range_m), scan.range_m, 0)[:, None]
    ring = None if scan.ring is None else np.ascontiguousarray(scan.ring, np.uint16)
    library.check_sensor(str(getattr(recording, "path", "recording")), sensor, np.ascontiguousarray(points, np.float32), ring)


def _kept(recording: Recording, columns: dict[str, Array], keep: tuple[str, float] | None) -> dict[str, Array]:
    """The rows whose column has the value; the others are counted."""
    if keep is None:
        return columns
    name, value = keep
    if name not in columns or columns[name].ndim != 1:
        raise FormatError(getattr(recording, "path", "recording"), "", f"no column {name} (--keep): "
                          + ", ".join(sorted(other for other, column in columns.items() if column.ndim == 1)))
    rows = columns[name] == value
    if not rows.all():
        recording.skipped[f"{name} is not {value:g} (--keep)"] += int(np.count_nonzero(~rows))
    return {other: column[rows] for other, column in columns.items()}


def inference_of(recording: Recording, sensor: str, unknown_below_deg: float | None = None) -> MissInference:
    """What infers the misses of a recording of point clouds. Raises `ValueError` where it is none."""
    path = getattr(recording, "path", "recording")
    if not isinstance(recording, BagRecording):
        raise ValueError(f"{path}: --infer-misses is for point clouds of bags, one a revolution")
    if recording.has_packets:
        raise ValueError(f"{path}: --infer-misses: packets have all their misses")
    if recording.world:
        raise ValueError(f"{path}: --infer-misses needs points in the sensor's frame, and these are in that of the poses")
    return MissInference(path, sensor, np.array(recording.scan_times()), unknown_below_deg)


def _scan_infos(library: Any, recording: Recording, poses: Poses | None) -> list[Any]:
    times_of = getattr(recording, "scan_times", None)
    if times_of is None or poses is None or not len(poses.time_s):
        return []
    times = np.array(times_of())
    position, rotation, inside = pose_at(poses, times)
    return [library.ScanInfo(k, float(times[k]), library.Pose(position[k], rotation[k]))
            for k in np.flatnonzero(inside & ~poses.in_gaps(times)).tolist()]


def _log(library: Any, info: Any, columns: dict[str, Array]) -> Any:
    extra = {name: _held(column) for name, column in columns.items() if name not in _NAMED}
    return library.log_from_columns(**{name: columns[name] for name in _NAMED}, extra=extra, info=info)


def _held(column: Array) -> Array:
    """A column of a type that a log holds: whole numbers of 64 bits and other types become double."""
    held = column.dtype.kind in "iu" and column.dtype.itemsize <= 4 or column.dtype in (np.float32, np.float64)
    return column.astype(column.dtype.newbyteorder("=")) if held else column.astype(np.float64)
