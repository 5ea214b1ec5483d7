"""Logs as NumPy arrays: beams in the world frame, and scans in the frame of the sensor."""
import dataclasses
import pathlib
import typing

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1", "char": "i1", "ushort": "<u2", "short": "<i2", "uint": "<u4",
         "int": "<i4"}
KITTI_PERIOD_S = 0.1035  # of one revolution in KITTI's synchronised drives, whose times are rounded to 10 ms


@dataclasses.dataclass(frozen=True)
class Log:
    """The n beams of a log in firing order, those of a scan in a row. `range_m` is NaN where a beam has no return."""
    origin: Floats     # (n, 3), m, world
    direction: Floats  # (n, 3), unit vectors, world
    range_m: Floats    # (n), m
    time_s: Floats     # (n)
    ring: Integers     # (n)
    scan: Integers     # (n), number of the scan, ascending
    world_from_sensor: dict[int, Floats]  # (4, 4) of each scan

    def scans(self) -> list[tuple[int, slice]]:
        """Number and rows of each scan, in order."""
        begins = np.flatnonzero(np.diff(self.scan, prepend=self.scan[0] - 1))
        return [(int(self.scan[a]), slice(int(a), int(b))) for a, b in zip(begins, [*begins[1:], len(self.scan)])]

    def poses(self) -> list[Floats]:
        """World from sensor, (4, 4), of each scan that has beams, in order."""
        return [self.world_from_sensor[number] for number, _ in self.scans()]

    def answered(self, range_m: Floats) -> "Log":
        """The same beams with other ranges."""
        return dataclasses.replace(self, range_m=range_m)

    def end_points(self) -> Floats:
        """The (n, 3) end points, m, world; NaN of beams without a return."""
        return self.origin + self.range_m[:, None] * self.direction


def pose_matrix(translation: typing.Sequence[float], quaternion: typing.Sequence[float]) -> Floats:
    """The (4, 4) matrix of a translation and a quaternion x y z w of any length but zero."""
    x, y, z, w = np.asarray(quaternion, float) / np.linalg.norm(quaternion)
    out: Floats = np.eye(4)
    out[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                   [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                   [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    out[:3, 3] = translation
    return out


def read_table(path: pathlib.Path) -> tuple[typing.Any, dict[int, Floats]]:
    """The rows of a log as `underbrush` writes it, as a structured array, and world from sensor, (4, 4), of each scan.
    Raises ValueError if it is no log or cut short."""
    fields: list[tuple[str, str]] = []
    poses: dict[int, Floats] = {}
    rows = 0
    with open(path, "rb") as file:
        while (line := file.readline()) and line.strip() != b"end_header":
            words = line.decode().split()
            if words[:3] == ["comment", "underbrush", "scan"]:
                numbers = [float(word) for word in words[5:12]]
                poses[int(words[3])] = pose_matrix(numbers[:3], numbers[3:])
            elif words[:2] == ["element", "vertex"]:
                rows = int(words[2])
            elif words[0] == "property":
                fields.append((words[2], TYPES[words[1]]))
        columns = {name for name, _ in fields}
        if not {"x", "nx", "alpha", "time", "ring", "scan"} <= columns or not poses:
            raise ValueError(f"{path}: no log of underbrush with rings and scans")
        table = np.fromfile(file, np.dtype(fields), rows)
    if len(table) != rows:
        raise ValueError(f"{path}: cut short")
    return table, poses


def read(path: pathlib.Path) -> Log:
    """Reads a log. Raises ValueError if it is none, or has beams without a direction or scans out of order."""
    table, poses = read_table(path)
    back = np.stack([table[name].astype(float) for name in ("nx", "ny", "nz")], axis=1)
    reach = np.linalg.norm(back, axis=1)
    end = np.stack([table[name].astype(float) for name in "xyz"], axis=1)
    scan = table["scan"].astype(np.int64)
    if not reach.all() or (np.diff(scan) < 0).any():
        raise ValueError(f"{path}: beams without a direction, or scans out of order")
    return Log(end + back, -back / reach[:, None], np.where(table["alpha"] > 0, reach, np.nan),
               table["time"].astype(float), table["ring"].astype(np.int64), scan, poses)


def ranges(path: pathlib.Path, like: Log) -> Floats:
    """The (n) ranges, m, of a simulation of the beams of `like`. Raises ValueError if its beams are others."""
    table, _ = read_table(path)
    back = np.stack([table[name] for name in ("nx", "ny", "nz")], axis=1)
    reach = np.linalg.norm(back, axis=1)
    if not np.array_equal(table["scan"], like.scan) or np.abs(back / reach[:, None] + like.direction).max() > 1e-4:
        raise ValueError(f"{path}: not the beams of the log that it answers")
    return np.where(table["alpha"] > 0, reach, np.nan).astype(float)


def clouds(log: Log) -> list[Floats]:
    """The returns of each scan, (m, 3), m, in the frame of the sensor at the time of the scan's pose. The beams'
    own origins are in it, so that a cloud of a moving sensor is de-skewed."""
    end, out = log.end_points(), []
    for number, rows in log.scans():
        pose, points = log.world_from_sensor[number], end[rows]
        points = points[~np.isnan(points[:, 0])]
        out.append((points - pose[:3, 3]) @ pose[:3, :3])
    return out


def straight_times(rounded_s: typing.Sequence[float], period_s: float = KITTI_PERIOD_S) -> list[float]:
    """Times of scans that are `period_s` apart, with the mean of the rounded ones. Raises ValueError where one is more
    than half a period away: a scan is then missing, or the period is another."""
    times = np.asarray(rounded_s, float)
    straight = period_s * np.arange(len(times))
    straight += (times - straight).mean()
    if np.abs(times - straight).max() > period_s / 2:
        raise ValueError(f"the times are not {period_s} s apart")
    return [float(t) for t in straight]
