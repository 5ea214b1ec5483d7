"""Writes scans as lidar drivers publish them: PointCloud2 in MCAP, ROS 2 and ROS 1 bags."""
from __future__ import annotations

import collections
import contextlib
import pathlib
import shutil
from collections.abc import Mapping
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from ._files import Array, PathLike, need, written_whole
from .layouts import LAYOUTS, points_from_columns
from .ros_messages import CLOUD, FIELD_TYPES, typestore
from .scans import Poses
from .trajectory import conjugate, pose_at, rotate

_TF = "tf2_msgs/msg/TFMessage"
_LATER = "echoes after the first"
#: Of the metadata of a ROS 2 folder; tools of before 2025 do not read the next one, 9.
_VERSION = 8


class BagWriter:
    """Writes a log of beams, scan by scan, with its poses as /tf.

    The kind follows from the name: `.mcap` and `.db3` are single ROS 2 files, `.bag` is a ROS 1 bag, any other a ROS 2
    folder (of MCAP); `compress` packs chunks (lz4 in ROS 1 bags, zstd in MCAP). `layout` is one of `LAYOUTS`. Points
    are in the sensor's frame at their own firing; times count from the scan's first beam.

    A cloud is organised, its misses kept, where the driver's is and all rings of the scan have as many beams: ouster
    then writes the first echo of each beam; velodyne does so only where no beam has several. Use it in a `with`; the
    file appears at its end, whole. `lost` counts what the layout cannot hold, `written` points and `scans` scans. It
    holds one scan in memory.
    """

    def __init__(self, path: PathLike, poses: Poses, *, layout: str = "ouster", topic: str = "/points",
                 frame: str = "lidar", world: str = "map", compress: bool = False) -> None:
        self._compress = compress
        if layout not in LAYOUTS:
            raise ValueError(f"no layout '{layout}': {', '.join(LAYOUTS)}")
        self.path, self.layout, self._poses = pathlib.Path(path), LAYOUTS[layout], _from_zero(poses)
        self._topic, self._frame, self._world = topic, frame, world
        self.lost: collections.Counter[str] = collections.Counter()
        self.written = self.scans = 0
        self._held: list[Mapping[str, Array]] = []  # Pieces of the scan that is being collected.
        self._next_pose, self._last_s = 0, -np.inf
        self._ros1 = self.path.suffix == ".bag"
        self._exit = contextlib.ExitStack()

    def __enter__(self) -> BagWriter:
        temporary = self._exit.enter_context(written_whole(self.path))
        store = typestore(self._ros1)
        if self._ros1:
            self._writer = need("rosbags.rosbag1").Writer(temporary)
            if self._compress:
                self._writer.set_compression(self._writer.CompressionFormat.LZ4)
        else:
            bag2 = need("rosbags.rosbag2")
            plugin = bag2.StoragePlugin.SQLITE3 if self.path.suffix == ".db3" else bag2.StoragePlugin.MCAP
            self._single = self.path.suffix if self.path.suffix in (".mcap", ".db3") else ""
            self._folder = temporary.with_suffix("") if self._single else temporary
            self._writer = bag2.Writer(self._folder, version=_VERSION, storage_plugin=plugin)
            if self._compress and plugin == bag2.StoragePlugin.MCAP:
                self._writer.set_compression(bag2.CompressionMode.STORAGE, bag2.CompressionFormat.ZSTD)
        self._temporary, self._store = temporary, store
        self._writer.open()
        self._clouds = self._writer.add_connection(self._topic, CLOUD, typestore=store)
        self._transforms = self._writer.add_connection("/tf", _TF, typestore=store)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        try:
            if kind is None:
                self._finish_scan()
                self._write_poses(np.inf)
                self._writer.close()
                if not self._ros1 and self._single:
                    shutil.move(self._folder / (self._folder.name + self._single), self._temporary)
            else:
                self._writer.abort()
        except BaseException as later:
            self._exit.__exit__(type(later), later, later.__traceback__)
            raise
        self._exit.__exit__(kind, error, trace)

    def write(self, columns: Mapping[str, Array]) -> None:
        """Appends beams, in columns as `place` names them; the beams of a scan follow each other."""
        scan = np.asarray(columns["scan"])
        starts = np.flatnonzero(np.append(True, np.diff(scan.astype(np.int64)) != 0)[:len(scan)])
        for begin, end in zip(starts, [*starts[1:], len(scan)]):
            if self._held and self._held[0]["scan"][0] != scan[begin]:
                self._finish_scan()
            self._held.append({name: np.asarray(column)[begin:end] for name, column in columns.items()})

    def _finish_scan(self) -> None:
        if not self._held:
            return
        columns: dict[str, Array] = {name: np.concatenate([piece[name] for piece in self._held])
                                     for name in self._held[0]}
        self._held = []
        start_s, end_s = float(columns["time_s"].min()), float(columns["time_s"].max())
        self._hold(columns["time_s"])
        stamp = _nanoseconds(start_s)
        points = _in_sensor_frame(columns, self._poses)
        order, shape = self._order(columns)
        kept = {name: column[order] for name, column in points.items()}
        if self.layout.name == "autoware":
            kept["return_type"] = return_types(columns)[order]
        cloud = points_from_columns(self.layout, kept, start_s, self.lost)
        self._write_poses(end_s)
        self._write_cloud(cloud, shape, stamp)
        self.written += len(order)
        self.scans += 1

    def _order(self, columns: Mapping[str, Array]) -> tuple[npt.NDArray[np.int64], tuple[int, int]]:
        """The rows to write, in order, and the cloud's rows and columns; counts what is left out."""
        hit = np.isfinite(columns["range_m"])
        rows = np.arange(len(hit))
        later = columns["echo"] > 1 if "echo" in columns else np.zeros(len(hit), bool)
        if "pulse_width" in columns:
            self.lost["pulse widths"] += int(np.count_nonzero(hit))
        if self.layout.miss is not None and (self.layout.name == "ouster" or not later.any()):
            if later.any():
                self.lost[_LATER] += int(np.count_nonzero(later))
                rows, hit = rows[~later], hit[~later]
            ring = columns["ring"][rows]
            counts = np.unique(ring, return_counts=True)[1]
            if len(counts) > 1 and np.all(counts == counts[0]):
                # Ring by ring, or firing by firing; a stable sort keeps the firings' order in each ring.
                grid = rows[np.lexsort((columns["time_s"][rows], ring))].reshape(len(counts), counts[0])
                if self.layout.rows == "firing":
                    grid = grid.T
                return grid.reshape(-1), (grid.shape[0], grid.shape[1])
        if not hit.all():
            self.lost["misses"] += int(np.count_nonzero(~hit))
        if self.layout.name not in ("ouster", "autoware") and later.any():
            self.lost["echo numbers"] += int(np.count_nonzero(later & np.isfinite(columns["range_m"])))
        return rows[hit], (1, int(np.count_nonzero(hit)))

    def _write_cloud(self, points: npt.NDArray[np.void], shape: tuple[int, int], stamp_ns: int) -> None:
        types, dtype = self._store.types, self.layout.dtype
        field = types["sensor_msgs/msg/PointField"]
        fields = [field(name=name, offset=dtype.fields[name][1], datatype=FIELD_TYPES.index(dtype[name].str[1:]),
                        count=1) for name in dtype.names or () if dtype.fields is not None]
        misses = shape[0] > 1 and bool(np.any(~(np.abs(points["x"]) + np.abs(points["y"]) + np.abs(points["z"]) > 0)))
        message = types[CLOUD](
            header=self._header(stamp_ns, self._frame), height=shape[0], width=shape[1], fields=fields,
            is_bigendian=False, point_step=dtype.itemsize, row_step=dtype.itemsize * shape[1],
            data=np.frombuffer(points.tobytes(), np.uint8), is_dense=not misses)
        self._send(self._clouds, stamp_ns, message, CLOUD)

    def _hold(self, time_s: Array) -> None:
        """Beams before the first or after the last pose have that pose, and readers must find it at their time."""
        times = self._poses.time_s
        outside = (time_s < times[0]) | (time_s > times[-1])
        if len(times) == 1 or not outside.any():
            return
        self.lost["beams outside the times of the poses (placed with the nearest)"] += int(np.count_nonzero(outside))
        if self._next_pose == 0 and time_s.min() < times[0]:
            self._write_pose(float(time_s.min()), 0)
        if time_s.max() > times[-1]:
            self._last_s = max(self._last_s, float(time_s.max()))

    def _write_poses(self, until_s: float) -> None:
        while self._next_pose < len(self._poses.time_s) and self._poses.time_s[self._next_pose] <= until_s:
            self._write_pose(float(self._poses.time_s[self._next_pose]), self._next_pose)
            self._next_pose += 1
        if until_s == np.inf and self._last_s > self._poses.time_s[-1]:
            self._write_pose(self._last_s + 1e-9, -1)

    def _write_pose(self, time_s: float, row: int) -> None:
        types, stamp = self._store.types, _nanoseconds(time_s)
        x, y, z, w = (float(v) for v in self._poses.rotation[row])
        transform = types["geometry_msgs/msg/Transform"](
            translation=types["geometry_msgs/msg/Vector3"](*(float(v) for v in self._poses.position[row])),
            rotation=types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w))
        stamped = types["geometry_msgs/msg/TransformStamped"](
            header=self._header(stamp, self._world), child_frame_id=self._frame, transform=transform)
        self._send(self._transforms, stamp, types[_TF](transforms=[stamped]), _TF)

    def _header(self, stamp_ns: int, frame: str) -> Any:
        types = self._store.types
        stamp = types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        sequence = {"seq": self.scans} if self._ros1 else {}
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **sequence)

    def _send(self, connection: Any, stamp_ns: int, message: Any, kind: str) -> None:
        write = self._store.serialize_ros1 if self._ros1 else self._store.serialize_cdr
        self._writer.write(connection, stamp_ns, write(message, kind))


def _nanoseconds(time_s: float) -> int:
    """Whole ns; a time before zero, which ROS does not have, is zero."""
    whole = int(np.floor(time_s))
    return max(0, whole * 10**9 + round((time_s - whole) * 1e9))


def _from_zero(poses: Poses) -> Poses:
    """The poses from time zero on, since ROS has no time before it."""
    if len(poses.time_s) < 2 or poses.time_s[0] >= 0 or poses.time_s[-1] <= 0:
        return poses
    times = np.append(0.0, poses.time_s[poses.time_s > 0])
    return Poses(times, *pose_at(poses, times)[:2])


def _in_sensor_frame(columns: Mapping[str, Array], poses: Poses) -> dict[str, Array]:
    """Points in the sensor's frame at their own time, and ranges from its origin."""
    position, rotation, _ = pose_at(poses, np.asarray(columns["time_s"], np.float64))
    far = np.nan_to_num(np.asarray(columns["range_m"], np.float64), posinf=1.0)
    direction = np.asarray(columns["direction"], np.float64)
    end = columns["origin"] + far[:, None] * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    xyz = rotate(conjugate(rotation), end - position)
    own = {"xyz", "direction", "origin", "time_s", "intensity", "ring", "scan", "packet", "flags", "echo", "echoes"}
    return {"xyz": xyz, "range_m": columns["range_m"], "time_s": columns["time_s"], "intensity": columns["intensity"],
            "ring": columns["ring"], **{name: c for name, c in columns.items() if name not in own | {"range_m"}}}


def return_types(columns: Mapping[str, Array]) -> Array:
    """Return types as Autoware numbers them: 1 for the only echo; of several the first is 3 (if the stronger) or 5, the
    last 4 (if the stronger) or 6, those between 0."""
    kind = np.ones(len(columns["range_m"]), np.uint8)
    if "echo" not in columns or "echoes" not in columns:
        return kind
    echo, echoes = columns["echo"].astype(np.int64), columns["echoes"].astype(np.int64)
    first = np.flatnonzero((echo == 1) & (echoes > 1))
    last = first + echoes[first] - 1
    whole = last < len(kind)
    first, last = first[whole], last[whole]
    kind[echoes > 1] = 0
    wins = columns["intensity"][first] >= columns["intensity"][last]
    kind[first], kind[last] = np.where(wins, 3, 5), np.where(wins, 6, 4)
    return kind


