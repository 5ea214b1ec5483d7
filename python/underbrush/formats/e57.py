"""E57 files of terrestrial scanners."""
from __future__ import annotations

import collections
import pathlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import Array, PathLike, guarded, need, with_thousands
from .scans import Poses, Scan, far_from_sensor
from .trajectory import in_order

_NEAR_POSE = 0.1  # Of the distance of points from the origin: nearer to the pose, they are in its world.
_FARTHEST_M, _ENOUGH = 30e3, 20  # No scanner measures as far; points.
_CHUNK = 1 << 18  # Points a scan.
_TYPES = {"cartesianX": "d", "cartesianY": "d", "cartesianZ": "d", "sphericalRange": "d", "sphericalAzimuth": "d",
          "sphericalElevation": "d", "cartesianInvalidState": "b", "sphericalInvalidState": "b", "intensity": "f",
          "rowIndex": "q", "columnIndex": "q", "returnIndex": "b", "returnCount": "b", "timeStamp": "d",
          "colorRed": "H", "colorGreen": "H", "colorBlue": "H"}
_EXTRA = {"timeStamp": "time_stamp", "rowIndex": "row", "columnIndex": "column",
          "colorRed": "red", "colorGreen": "green", "colorBlue": "blue"}
_BASE = (("cartesianX", "cartesianY", "cartesianZ"), ("sphericalRange", "sphericalAzimuth", "sphericalElevation"))


def _points(scan: Scan) -> npt.NDArray[np.float64]:
    """The hits of a scan, (n, 3), m."""
    if scan.xyz is not None:
        return scan.xyz[np.isfinite(scan.xyz[:, 0])]
    assert scan.direction is not None and scan.range_m is not None
    hit = np.isfinite(scan.range_m)
    return np.asarray(scan.direction[hit] * scan.range_m[hit, None].astype(np.float64))


class E57Recording:
    """An E57 file. A scan is a piece of a quarter million points of one station, in the station's frame.

    Beams whose point is given as a direction only (invalid state 1) are misses and kept; those without a direction
    (state 2) are left out and counted. Each station's pose comes from the file; its time is the number of the station,
    since stations seldom have one: `poses` has a pose for each. `station` is the number or the name of the only one to
    read.
    """

    sensor = ""
    crs = ""
    world = False

    def __init__(self, path: PathLike, station: str | None = None, unit_m: float = 1.0) -> None:
        self.path, self._file_unit_m = pathlib.Path(path), unit_m
        self.skipped: collections.Counter[str] = collections.Counter()
        self.bytes_total, self.bytes_done = self.path.stat().st_size, 0
        self._lib = need("pye57").libe57
        with guarded(path, "header"):
            file = self._lib.ImageFile(str(self.path), "r")
            try:
                self._describe(file)
                self._chosen = self._numbers_of(station)
                self._take_for_world(file)
            finally:
                file.close()

    def _describe(self, file: Any) -> None:
        root = file.root()
        if root.isDefined("coordinateMetadata"):
            self.crs = str(root["coordinateMetadata"].value())
        self._stations: list[tuple[int, list[str], str]] = []
        self._posed = False
        rows = []
        for number in range(len(root["data3D"])):
            node = root["data3D"][number]
            prototype = self._lib.StructureNode(node["points"].prototype())
            names = [prototype.get(k).elementName() for k in range(prototype.childCount())]
            count = int(node["points"].childCount())
            if count and not any(set(base) <= set(names) for base in _BASE):
                raise FormatError(self.path, f"station {number}", "neither Cartesian nor spherical coordinates")
            self._stations.append((count, names, str(node["name"].value()) if node.isDefined("name") else ""))
            position, q = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
            if node.isDefined("pose"):
                pose = node["pose"]
                if pose.isDefined("translation"):
                    position = [pose["translation"][axis].value() * self._file_unit_m for axis in "xyz"]
                if pose.isDefined("rotation"):
                    q = [pose["rotation"][axis].value() for axis in "wxyz"]
            self._posed = self._posed or any(position) or list(map(abs, q)) != [1.0, 0.0, 0.0, 0.0]
            rows.append([float(number), *position, *q[1:], q[0]])
        if not rows:
            raise FormatError(self.path, "", "no scans in it")
        table = np.array(rows)
        self.poses: Poses | None = in_order(table[:, 0], table[:, 1:4], table[:, 4:])
        if len(self.poses.time_s) < len(rows):
            raise FormatError(self.path, "pose", "a station's pose is no rotation or not finite")

    def _numbers_of(self, station: str | None) -> list[int]:
        """Numbers of the stations to read. Raises `ValueError` where there is none of that number or name."""
        titles = [title for _, _, title in self._stations]
        numbers = [k for k, title in enumerate(titles) if station in (None, title)] or [
            k for k in range(len(titles)) if station == str(k)]
        if not numbers:
            raise ValueError(f"no station '{station}': " + ", ".join(
                f"{k} {title}".strip() for k, title in enumerate(titles[:20])) + (", …" if len(titles) > 20 else ""))
        self.organised = any("InvalidState" in name for k in numbers for name in self._stations[k][1])
        return numbers

    def pose_times(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The numbers of the stations, which are their times."""
        return np.arange(len(self._stations), dtype=np.float64)

    def used_poses(self) -> Poses | None:
        """The poses of the stations that are read."""
        if self.poses is None or len(self.poses.time_s) != len(self._stations):
            return self.poses
        rows = self._chosen
        return Poses(self.poses.time_s[rows], self.poses.position[rows], self.poses.rotation[rows])

    def _take_for_world(self, file: Any) -> None:
        """Points far away but close together have coordinates of the world. Of the pose, only the position then counts,
        if it is not the origin."""
        station = self._chosen[0]
        count, names, _ = self._stations[station]
        if not count:
            return
        scan = self._scan(next(self._pieces(file, station, count, names)), 0, station)
        self.skipped.clear()
        self.world = self._are_of_world(_points(scan), station)
        if self.world and not self._posed:
            self.poses = None

    def _are_of_world(self, points: npt.NDArray[np.float64], station: int) -> bool:
        """Whether points are far away but close together, and their station has no pose, or one near them. Raises
        `FormatError` where they are too far away for any scanner."""
        if not far_from_sensor(points):
            return False
        if not self._posed or self.poses is None:
            return True
        nearest, from_pose = (float(np.linalg.norm(points - place, axis=1).min())
                              for place in (np.zeros(3), self.poses.position[station]))
        if from_pose >= _NEAR_POSE * nearest and nearest > _FARTHEST_M:
            raise FormatError(self.path, f"station {station}", f"its points lie {nearest / 1e3:.0f} km from the scanner, as "
                              "those of the world do, but not near its pose either: remove the pose, or move the points to "
                              "the scanner's frame")
        return from_pose < _NEAR_POSE * nearest

    def notes(self) -> list[str]:
        """What was assumed, one line each."""
        if self.world and self._posed:
            return ["the points have the coordinates of the world already: of the stations' poses, only the positions are "
                    "used"]
        if self.poses is not None and not self._posed:
            return ["the stations have no poses: the scanner is taken to stand at the origin of the coordinates"]
        return []

    def found(self) -> list[str]:
        lines = [f"E57, {len(self._stations)} stations, {self.bytes_total / 1e6:.1f} MB"]
        for number, (count, names, title) in enumerate(self._stations):
            place = "" if self.poses is None else "at {:.2f} {:.2f} {:.2f} m; ".format(*self.poses.position[number])
            lines.append(f"station {number} {title}: {with_thousands(count)} points; {place}" + ", ".join(names))
        return [*lines, f"CRS {self.crs}" if self.crs else "no CRS"]

    def scans(self) -> Iterator[Scan]:
        self.bytes_done = number = done = 0
        total = max(1, sum(self._stations[k][0] for k in self._chosen))
        with guarded(self.path, "open"):
            file = self._lib.ImageFile(str(self.path), "r")
        try:
            for station in self._chosen:
                count, names, _ = self._stations[station]
                first = True
                for columns in self._pieces(file, station, count, names):
                    scan = self._scan(columns, number, station)
                    points = _points(scan) if first and self._posed else np.empty((0, 3))
                    if len(points) >= _ENOUGH and self._are_of_world(points, station) != self.world:
                        raise FormatError(self.path, f"station {station}", "of the points of some stations, the coordinates "
                                          "are those of the world, and of others their scanner's: read one with --topic "
                                          f"{station}")
                    first = False
                    done += len(columns[next(iter(columns))])
                    self.bytes_done = self.bytes_total * done // total
                    if len(scan):
                        yield scan
                        number += 1
        finally:
            file.close()

    def _pieces(self, file: Any, station: int, count: int, names: list[str]) -> Iterator[dict[str, Array]]:
        """Columns of a station's points, piece by piece."""
        size = min(_CHUNK, max(1, count))
        buffers, arrays = self._lib.VectorSourceDestBuffer(), {}
        place = f"station {station}"
        with guarded(self.path, place):
            for name in names:
                if name in _TYPES:
                    arrays[name] = np.empty(size, _TYPES[name])
                    buffers.append(self._lib.SourceDestBuffer(file, name, arrays[name], size, True, True))
            reader = file.root()["data3D"][station]["points"].reader(buffers)
        read = 0
        try:
            while read < count:
                with guarded(self.path, place):
                    got = int(reader.read())
                    if not got:
                        raise ValueError(f"{count} points are promised, {read} are there: truncated")
                read += got
                yield {name: array[:got].copy() for name, array in arrays.items()}
        finally:
            reader.close()

    def _scan(self, c: dict[str, Array], number: int, station: int) -> Scan:
        n = len(next(iter(c.values())))
        if set(_BASE[0]) <= set(c):
            vector = np.column_stack([c[name] for name in _BASE[0]])
            state = c.get("cartesianInvalidState", np.zeros(n, np.int8))
        else:
            distance, azimuth, elevation = (c[name] for name in _BASE[1])
            state = c.get("sphericalInvalidState", np.zeros(n, np.int8))
            if np.abs(elevation[state == 0]).max(initial=0) > 0.51 * np.pi or np.abs(azimuth).max(initial=0) > 2.01 * np.pi:
                raise FormatError(self.path, f"station {station}", "angles beyond a turn in radians: are they in degrees?")
            distance = np.where(state == 1, 1.0, distance)
            flat = distance * np.cos(elevation)
            vector = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), distance * np.sin(elevation)])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            length = np.sqrt(np.einsum("ij,ij->i", vector, vector))
            keep = (length > 1e-9) & (length < 1e9) & ((state == 0) | (state == 1))
            if not keep.all():
                self.skipped["beams without a point or a direction"] += int(np.count_nonzero(~keep))
            unit = np.where(state[keep] == 1, 1.0, self._file_unit_m)
            vector, length, state = unit[:, None] * vector[keep], unit * length[keep], state[keep]
            if self.world:
                vector[state == 1] = np.nan  # A direction from where the scanner stood, which is not known.
                scan = Scan(number, float(station), xyz=vector)
            else:
                scan = Scan(number, float(station), direction=vector / length[:, None],
                            range_m=np.where(state == 1, np.inf, length).astype(np.float32))
        scan.beam_time_s = np.full(len(scan), float(station))
        if "intensity" in c:
            scan.intensity = np.where(state == 1, 0, c["intensity"][keep]).astype(np.float32)
        if "returnIndex" in c and "returnCount" in c:
            count = c["returnCount"][keep].astype(np.uint8)
            scan.echo = np.where(state == 1, 0, c["returnIndex"][keep] + 1).astype(np.uint8)
            scan.echoes = np.where(state == 1, 0, count).astype(np.uint8)
        scan.extra = {new: c[name][keep].astype(np.int32 if c[name].dtype == np.int64 else c[name].dtype)
                      for name, new in _EXTRA.items() if name in c}
        scan.extra["station"] = np.full(len(scan), station, np.uint16)
        return scan
