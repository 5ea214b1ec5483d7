"""Places scans in the world: each beam gets the sensor's pose at its own time, and each miss its direction."""
from __future__ import annotations

import collections
from collections.abc import Callable, Iterator, Sequence

import numpy as np
import numpy.typing as npt

from .._core import grid_directions, group_times, place_rays
from ..errors import FormatError
from ._files import Array, OptionMissing, PathLike
from .airborne import estimate_poses
from .bag import BagRecording
from .infer_misses import MissInference
from .scans import NO_POSES, Poses, Recording, Scan, Survey, far_from_sensor
from .trajectory import pose_at, read_poses

Floats = npt.NDArray[np.float64]

IN_GAPS = "beams in gaps of the poses"
_LEAST_RANGE_M = 1e-6  # A shorter range has no direction.
_NO_TURN = np.array([[0.0, 0.0, 0.0, 1.0]])
_STILL_M = 1.0
_STILL_DEG = 3.0
_FARTHEST_M = 30e3  # Aircraft fly up to 20 km above what they survey.
_PACKET_S = 1e-3  # Beams within a millisecond share a packet.


def beams(recording: Recording, *, poses: Poses | PathLike | None = None,
          position: Sequence[float] | None = None, infer: MissInference | None = None,
          frames: range | None = None, check: Callable[[Scan], None] | None = None) -> Iterator[dict[str, Array]]:
    """Beams of all scans of a recording in the world frame, a mapping of columns a scan (see `place`).

    `infer` adds the misses that point clouds lack, `frames` has the numbers of the scans to read, and `check` sees the
    first one that has points. `poses` (or a
    file of them, see `read_poses`, or a topic) take the place of the recording's own; `position` (x y z, world) is the
    place of a sensor that stands still. It is in m, and so are `Poses`, but a position and a file of poses for a survey
    file have its coordinates, in its unit. Without both, the positions of an airborne sensor are estimated from a
    survey file. What is left out is counted in `recording.skipped`. Raises `OptionMissing` with one line that names the
    option to add if the place of the sensor is not known, `FormatError` if it is far from the points.
    """
    path = getattr(recording, "path", "recording")
    known = poses_of(recording, poses, estimated=position is None)
    attitude = _NO_TURN
    if position is not None:
        attitude = _attitude(path, known if poses else getattr(recording, "used_poses", lambda: known)())
        position = np.asarray(position, np.float64) * getattr(recording, "unit_m", 1.0)
    first = True
    if frames is not None and not getattr(recording, "numbered", False):
        raise ValueError(f"{path}: --frames is for recordings of scans: bags and packet captures")
    for scan in recording.scans():
        if frames is not None and scan.number not in frames:
            if scan.number >= frames[-1]:
                break
            continue
        if first and recording.world and scan.direction is None and position is None:
            if known is None:
                raise OptionMissing(f"{path}: world coordinates need the sensor's place: add --poses FILE "
                                    "(GPS time x y z) or, for a tripod, --position X,Y,Z")
            if scan.beam_time_s is None and isinstance(recording, Survey):
                raise OptionMissing(f"{path}: no gps_time, so a trajectory cannot be used: add --position X,Y,Z")
        elif first and known is None and not recording.world and position is None:
            raise OptionMissing(recording.ask_poses() if isinstance(recording, BagRecording) else f"{path}: {NO_POSES}")
        first = False
        if check is not None and len(scan):
            check(scan)
            check = None
        if infer is not None:
            scan = infer.added(scan, recording.skipped)
        columns = place(scan, known, world=recording.world, position=position, attitude=attitude,
                        skipped=recording.skipped)
        yield _near(path, columns, position is not None, recording.skipped) if recording.world else columns


def _attitude(path: PathLike, known: Poses | None) -> Floats:
    """The rotation (1, 4) of a sensor that stands still: the first of its poses, if it has any. Raises `ValueError`
    where it moves or turns by its poses, so that it has no single place."""
    if known is None or not len(known.time_s):
        return _NO_TURN
    moved_m = float(np.linalg.norm(known.position - known.position[0], axis=1).max())
    turned = 2 * np.arccos(np.clip(np.abs(known.rotation @ known.rotation[0]), 0, 1)).max()
    if moved_m > _STILL_M or turned > np.radians(_STILL_DEG):
        how = f"moves by {moved_m:.1f} m" if moved_m > _STILL_M else f"turns by {np.degrees(turned):.0f}°"
        raise ValueError(f"{path}: by its poses the sensor {how}, and --position is for one that stands still: leave "
                         "it out, or read one station of an E57 with --topic")
    return known.rotation[:1]


def _near(path: PathLike, columns: dict[str, Array], still: bool, skipped: collections.Counter[str]
          ) -> dict[str, Array]:
    """The beams without those that end too far from the sensor, which are counted. Raises `FormatError` where most do:
    the sensor's places and the points have different coordinates."""
    far = np.isfinite(columns["range_m"]) & (columns["range_m"] > _FARTHEST_M)
    if not far.any():
        return columns
    if 2 * np.count_nonzero(far) > len(far):
        row = int(np.flatnonzero(far)[len(np.flatnonzero(far)) // 2])
        place, range_m = columns["origin"][row], float(columns["range_m"][row])
        point = place + range_m * columns["direction"][row].astype(np.float64)
        why = "both must have the coordinates of the file"
        if np.linalg.norm(place[[1, 0, 2]] - point) < _FARTHEST_M:
            why = "x (east) must stand before y (north)"
        elif np.all(np.abs(place[:2]) <= [360, 90]):
            why += ", and these are degrees or those of a site of its own"
        raise FormatError(path, "--position" if still else "--poses", f"the sensor at {_text(place)} is "
                          f"{range_m / 1e3:.0f} km from the points around {_text(point)} m: {why}")
    skipped[f"points farther than {_FARTHEST_M / 1e3:.0f} km from the sensor"] += int(np.count_nonzero(far))
    return {name: column[~far] for name, column in columns.items()}


def _text(point: Floats) -> str:
    return " ".join(f"{value:.1f}" for value in point)


def poses_of(recording: Recording, given: Poses | PathLike | None, estimated: bool = False) -> Poses | None:
    """The poses given, those of a file or of a topic of the recording, the recording's own, or those that are estimated
    from its points."""
    if isinstance(given, Poses):
        return given
    if not given:
        if estimated and recording.poses is None and isinstance(recording, Survey):
            estimate_poses(recording)
        return recording.poses
    if isinstance(recording, BagRecording):
        recording.take_poses(given)
        return recording.poses
    return read_poses_of(recording, given)


def read_poses_of(recording: Recording, path: PathLike) -> Poses:
    """The poses of a file, which has the coordinates of the recording."""
    poses = read_poses(path, getattr(recording, "pose_times", None), places_only=recording.world)
    poses.position = poses.position * np.array(getattr(recording, "unit_m", 1.0))
    return poses


def place(scan: Scan, poses: Poses | None, *, world: bool = False, position: Sequence[float] | None = None,
          attitude: Floats = _NO_TURN, skipped: collections.Counter[str] | None = None) -> dict[str, Array]:
    """The beams of a scan in the world frame, in order of time. A sensor at a `position` has the rotation `attitude`, a
    quaternion (1, 4) x y z w.

    Columns, n entries each: `origin` (n, 3) float64, m; `direction` (n, 3) float32, unit vectors; `range_m` float32,
    infinity for a miss; `intensity` float32; `time_s` float64; `ring` uint16; `scan` and `packet` (ms after the
    scan's first beam) uint32; `flags` uint8; `echo` and `echoes` uint8 where the scan has them; the scan's further
    columns by name. With `world`, `xyz` are world coordinates and only the sensor's positions are used. Beams outside
    the poses' times and misses without a direction are left out and counted in `skipped`.
    """
    skipped = collections.Counter() if skipped is None else skipped
    n = len(scan)
    time = scan.beam_time_s if scan.beam_time_s is not None else np.full(n, scan.time_s)
    times, group, order = group_times(np.ascontiguousarray(time, np.float64))
    moves = position is None and poses is not None and len(poses.time_s) > 0
    if position is not None:
        known = np.asarray(position, np.float64).reshape(1, 3), attitude, np.ones(1, bool)
        group = np.zeros(n, np.uint32)
    elif moves and poses is not None:
        known = pose_at(poses, times)  # Beams of equal time, and there are many, share an interpolated pose.
    elif world and scan.origin is not None:
        known = scan.origin, _NO_TURN, np.ones(n, bool)
        group = np.arange(n, dtype=np.uint32)
    else:
        raise ValueError("neither poses nor a position")
    places, turns, inside = _columns(known[0]), _columns(known[1]), np.ascontiguousarray(known[2])
    gaps = 0
    if moves and poses is not None and len(poses.gaps):
        gap = poses.in_gaps(times)
        inside, gaps = inside & ~gap, int(np.count_nonzero(gap[group]))
    points, instead, direction, range_m = scan.xyz, None, scan.direction, scan.range_m
    if direction is not None and range_m is not None:
        points = None
    else:
        assert points is not None
        direction = range_m = None
        if not world and far_from_sensor(points):
            raise OptionMissing("its points lie far from the sensor and close together: are its coordinates those of "
                                "the world?")
        if not world and not np.isfinite(points).all():
            instead = directions_of_misses(scan)
    rows, origin, direction, distance, left = place_rays(
        *(_columns(column) for column in (points, instead, direction)),
        None if range_m is None else np.ascontiguousarray(range_m, np.float32), _columns(scan.origin), group, places,
        None if world else turns, inside, order, _LEAST_RANGE_M)
    if not moves:
        left[1] = 0  # Only flight lines lack positions.
    left[0] -= gaps
    for count, reason in zip((gaps, *left), (IN_GAPS, "beams outside the times of the poses",
                                    "points of flight lines whose sensor positions cannot be estimated",
                                    "misses whose direction cannot be found", "points at the sensor itself")):
        if count:
            skipped[reason] += count
    time = time[rows]
    hit = np.isfinite(distance)
    columns: dict[str, Array] = {
        "origin": origin, "direction": direction, "range_m": distance, "time_s": time,
        "intensity": np.where(hit, scan.intensity[rows], np.float32(0)) if scan.intensity is not None
        else np.zeros(len(rows), np.float32),
        "ring": scan.ring[rows] if scan.ring is not None else np.zeros(len(rows), np.uint16),
        "scan": scan.extra["scan"][rows].astype(np.uint32) if "scan" in scan.extra
        else np.full(len(rows), scan.number, np.uint32),
        "packet": ((time - time[0]) / _PACKET_S if len(rows) else time).astype(np.uint32),
        "flags": scan.extra["flags"][rows].astype(np.uint8) if "flags" in scan.extra
        else np.zeros(len(rows), np.uint8)}
    if scan.echo is not None:
        columns["echo"] = scan.echo[rows]
    if scan.echoes is not None:
        columns["echoes"] = scan.echoes[rows]
    columns.update((name, column[rows]) for name, column in scan.extra.items() if name not in columns)
    return columns


def _columns(column: Floats | None) -> Floats | None:
    """Doubles, row by row."""
    return None if column is None else np.ascontiguousarray(column, np.float64)


def directions_of_misses(scan: Scan) -> Floats:
    """Directions (n, 3) of the beams of an organised scan in the sensor's frame, found from its hits.

    In a spinning sensor's grid the elevation is that of the ring and the azimuth is the column's plus the ring's.
    Both are means over the hits, weighted by the range squared because lasers do not start at the origin. All are
    NaN where there is no grid, or where it does not explain the hits to half a degree.
    """
    nothing = np.full((len(scan), 3), np.nan)
    if scan.xyz is None or scan.shape is None or scan.shape[0] * scan.shape[1] != len(scan):
        return nothing
    by_ring = True
    if scan.ring is not None and not np.all((ring := scan.ring.reshape(scan.shape)) == ring[:, :1]):
        if not np.all(ring == ring[:1]):
            return nothing
        by_ring = False  # A row is a firing.
    found = grid_directions(np.ascontiguousarray(scan.xyz), *scan.shape, by_ring)
    return nothing if found is None else found
