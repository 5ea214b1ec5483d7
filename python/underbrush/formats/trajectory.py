"""Poses of a sensor: interpolation in time, composition, and files of poses."""
from __future__ import annotations

import pathlib
import re
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from ..errors import FormatError
from ._files import PathLike
from .scans import Poses

Floats = npt.NDArray[np.float64]

_LONGEST_LINE = 4096
_QUATERNION, _ANGLES = ("qx", "qy", "qz", "qw"), ("roll", "pitch", "yaw")
#: What the columns of these names are; others are recognised by their parts.
_NAMES = {name: what for what, names in {
    "t": "t sec secs seconds s", "nsec": "nsec nsecs nanosec nanosecs nanoseconds", "x": "x easting east e",
    "y": "northing north n", "z": "z height h altitude alt elevation elev ellipsoidalheight up",
    "roll": "roll r", "pitch": "pitch p", "yaw": "yaw", "heading": "heading azimuth"}.items() for name in names.split()}


def multiply(a: Floats, b: Floats) -> Floats:
    """Product of quaternions x y z w, (n, 4) each: first `b`, then `a`."""
    ax, ay, az, aw = np.moveaxis(a, -1, 0)
    bx, by, bz, bw = np.moveaxis(b, -1, 0)
    return np.stack([aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                     aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz], axis=-1)


def conjugate(q: Floats) -> Floats:
    """Inverse rotations of unit quaternions, (n, 4)."""
    return np.asarray(q * np.array([-1.0, -1.0, -1.0, 1.0]))


def rotate(q: Floats, v: Floats) -> Floats:
    """Vectors (n, 3) turned by unit quaternions (n, 4)."""
    x, y, z, w = np.moveaxis(q, -1, 0)
    a, b, c = np.moveaxis(v, -1, 0)
    # v + 2 w (axis × v) + 2 axis × (axis × v); numpy.cross takes three times as long.
    r, s, t = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return np.stack([a + w * r + y * t - z * s, b + w * s + z * r - x * t, c + w * t + x * s - y * r], axis=-1)


def slerp(a: Floats, b: Floats, share: Floats) -> Floats:
    """Rotations at the shares (n,), 0 to 1, of the shorter way from `a` to `b`, (n, 4)."""
    dot = np.sum(a * b, axis=-1)
    b = np.where(dot[:, None] < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(dot), 0, 1))
    sine = np.sin(angle)
    near = sine < 1e-6  # The chord equals the arc to 1e-13 there.
    with np.errstate(invalid="ignore", divide="ignore"):
        wa = np.where(near, 1 - share, np.sin((1 - share) * angle) / sine)
        wb = np.where(near, share, np.sin(share * angle) / sine)
    q = wa[:, None] * a + wb[:, None] * b
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True), dtype=np.float64)


def pose_at(poses: Poses, time_s: Floats) -> tuple[Floats, Floats, npt.NDArray[np.bool_]]:
    """Positions (n, 3), rotations (n, 4), and whether the time lies within the poses' times.

    Positions are interpolated linearly and rotations by slerp. Outside, the nearest pose is given. A
    single pose holds at all times.
    """
    times = poses.time_s
    if len(times) == 1:
        n = len(time_s)
        return np.tile(poses.position, (n, 1)), np.tile(poses.rotation, (n, 1)), np.ones(n, bool)
    after = np.clip(np.searchsorted(times, time_s, side="right"), 1, len(times) - 1)
    before = after - 1
    share = np.clip((time_s - times[before]) / (times[after] - times[before]), 0, 1)
    position = poses.position[before] * (1 - share[:, None]) + poses.position[after] * share[:, None]
    rotation = slerp(poses.rotation[before], poses.rotation[after], share)
    return position, rotation, (time_s >= times[0]) & (time_s <= times[-1])


def in_order(time_s: Floats, position: Floats, rotation: Floats) -> Poses:
    """Poses sorted by time; of equal times the last is kept, rows that are not finite are left out."""
    norm = np.linalg.norm(rotation, axis=1)
    good = np.isfinite(time_s) & np.isfinite(position).all(axis=1) & (np.abs(norm - 1) < 0.005)
    rows = np.flatnonzero(good)
    rows = rows[np.argsort(time_s[rows], kind="stable")]
    if len(rows):
        rows = rows[np.append(np.diff(time_s[rows]) > 0, True)]
    return Poses(time_s[rows], position[rows], rotation[rows] / norm[rows, None])


def compose(outer: Poses, inner: Poses) -> Poses:
    """Poses of a chain of two: `outer` is world from middle, `inner` is middle from sensor.

    The times are all of both between the later start and the earlier end; a single pose holds always.
    """
    moving = [p for p in (outer, inner) if len(p.time_s) > 1]
    times = np.unique(np.concatenate([p.time_s for p in moving])) if moving else outer.time_s
    for p in moving:
        times = times[(times >= p.time_s[0]) & (times <= p.time_s[-1])]
    position, rotation, _ = pose_at(outer, times)
    offset, turn, _ = pose_at(inner, times)
    return Poses(times, position + rotate(rotation, offset), multiply(rotation, turn))


def from_matrices(m: Floats) -> Floats:
    """Quaternions (n, 4) of rotation matrices (n, 3, 3)."""
    # The largest of the four ways to take the root, so that no digits are lost.
    trace = np.trace(m, axis1=1, axis2=2)
    d = np.stack([m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]], axis=1)
    size = np.column_stack([1 - trace[:, None] + 2 * d, 1 + trace])
    off = m - np.swapaxes(m, 1, 2)
    both = m + np.swapaxes(m, 1, 2)
    w = np.stack([off[:, 2, 1], off[:, 0, 2], off[:, 1, 0]], axis=1)
    rows = np.stack([
        np.stack([size[:, 0], both[:, 0, 1], both[:, 0, 2], w[:, 0]], axis=1),
        np.stack([both[:, 0, 1], size[:, 1], both[:, 1, 2], w[:, 1]], axis=1),
        np.stack([both[:, 0, 2], both[:, 1, 2], size[:, 2], w[:, 2]], axis=1),
        np.column_stack([w, size[:, 3]])], axis=1)
    q = rows[np.arange(len(m)), np.argmax(size, axis=1)]
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True), dtype=np.float64)


def from_angles(roll: Floats, pitch: Floats, yaw: Floats) -> Floats:
    """Quaternions (n, 4) of turns about x, then y, then z, rad."""
    def about(axis: int, angle: Floats) -> Floats:
        q = np.zeros((len(angle), 4))
        q[:, axis], q[:, 3] = np.sin(angle / 2), np.cos(angle / 2)
        return q

    return multiply(about(2, yaw), multiply(about(1, pitch), about(0, roll)))


def _named_columns(line: str) -> tuple[dict[str, int], int]:
    """The columns of t x y z, of the quaternion qx qy qz qw and of the angles roll pitch yaw that a line of names has,
    such as `#timestamp, p_RS_R_x [m], …, q_RS_w []` or `GPSTime,Easting,Northing,Height`, and how many names it has.
    Empty where a name stands twice, and where time or place are not all there."""
    text = re.sub(r"\[[^\]]*\]|\([^)]*\)", "", line.lower()).lstrip("#/ \ufeff").strip()
    names = [re.sub(r"[^a-z0-9_.]", "", name) for name in re.split(r"[,;]" if re.search("[,;]", text) else r"\s+", text)]
    names = [re.sub(r"_(deg|rad|m|s)$", "", name) for name in names]
    if names[-1:] == [""]:
        names.pop()
    found: dict[str, int] = {}
    for column, name in enumerate(names):
        if not name or name.startswith(("v_", "w_", "a_", "b_")):
            continue
        turns = "q" in name or "rot" in name or "orient" in name or name.endswith("w")
        if name in _NAMES:
            what = _NAMES[name]
        elif "time" in name or "stamp" in name:
            what = "t"
        elif name == "y" and names[max(0, column - 2):column] == ["r", "p"]:
            what = "yaw"
        elif name[-1] in "xyzw" and not name.endswith("yaw"):
            what = ("q" if turns else "") + name[-1]
        else:
            continue
        if what in found:
            return {}, 0
        found[what] = column
    return (found, len(names)) if all(what in found for what in "txyz") else ({}, 0)


def _ordered(table: Floats, found: dict[str, int], places_only: bool, path: PathLike, head: str) -> Poses:
    """Poses of the columns that a line of names has named."""
    time, place = table[:, found["t"]], table[:, [found[axis] for axis in "xyz"]]
    if "nsec" in found:
        time = time + 1e-9 * table[:, found["nsec"]]
    time = time * _seconds_of_dates(time)
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(table), 1))
    if all(what in found for what in _QUATERNION):
        turns = table[:, [found[what] for what in _QUATERNION]]
    elif not places_only and table.shape[1] > 4 + ("nsec" in found) and not all(what in found for what in _ANGLES):
        if "heading" not in found:
            raise FormatError(path, "line 1", "names no rotation (qx qy qz qw, or roll pitch yaw)")
        raise FormatError(path, "line 1", "roll, pitch and heading are angles of an aircraft: give quaternions "
                                          "(t x y z qx qy qz qw, world from sensor)")
    elif all(what in found for what in _ANGLES):
        angles = table[:, [found[what] for what in _ANGLES]]
        most = np.abs(angles).max()
        if "rad" not in head and "deg" not in head and 0 < most <= 2.001 * np.pi:
            raise FormatError(path, "header", "are its angles radians or degrees? Say so in the header, as in yaw [rad] or "
                                              "yaw [deg]")
        turns = from_angles(*(angles if "rad" in head else np.deg2rad(angles)).T)
    return in_order(time, place, turns)


def _seconds_of_dates(times: Floats) -> float:
    """The unit (s) of times that are dates from 2001 on in ms, µs or ns; else 1."""
    for unit in (1e-3, 1e-6, 1e-9):
        if float(times.min()) * unit > 1e9 and float(times.max()) * unit < 4.2e9:
            return unit
    return 1.0


def _is_helios(table: Floats) -> bool:
    """Whether columns can be x y z t roll pitch yaw: times that rise, and angles (degrees)."""
    return bool(np.all(np.diff(table[:, 3]) > 0) and np.all(np.abs(table[:, 4:]) <= 360))


def _not_helios(table: Floats) -> str:
    """Why rows of seven columns are no trajectory of HELIOS++, or may be of another order; "" if they are one."""
    if len(table) > 1 and np.abs(np.linalg.norm(table[:, 3:], axis=1) - 1).max() < 0.005:
        return "7 columns that end in a quaternion have no times: begin each row with the time"
    if not _is_helios(table) and np.all(np.diff(table[:, 0]) > 0) and np.all(np.abs(table[:, 1:]) <= 360):
        return ("7 columns may be t roll pitch yaw x y z or t x y z roll pitch yaw: name them in a line above them, with "
                "yaw [deg] or yaw [rad]")
    return ""


def _of_matrices(time_s: Floats, rows: Floats) -> Poses:
    """Poses of row-major 3×4 matrices (n, 12); those that are no rotations are left out."""
    m = rows.reshape(-1, 3, 4)
    turn = m[:, :, :3]
    off = np.abs(turn @ np.swapaxes(turn, 1, 2) - np.eye(3)).max(axis=(1, 2))
    rotation = from_matrices(turn)
    rotation[~((off < 0.02) & (np.linalg.det(turn) > 0))] = np.nan
    return in_order(time_s, m[:, :, 3], rotation)


def beyond_ends(poses: Poses) -> Poses:
    """The poses with one more before and after them, to which the motion at the ends goes on."""
    if len(poses.time_s) < 2:
        return poses
    (a, b), (y, z) = (0, 1), (-2, -1)
    t, p, q = poses.time_s, poses.position, poses.rotation
    first = multiply(q[[a]], multiply(conjugate(q[[b]]), q[[a]]))
    last = multiply(q[[z]], multiply(conjugate(q[[y]]), q[[z]]))
    return Poses(np.concatenate([[2 * t[a] - t[b]], t, [2 * t[z] - t[y]]]),
                 np.concatenate([[2 * p[a] - p[b]], p, [2 * p[z] - p[y]]]), np.concatenate([first, q, last]))


def _of_scans(path: PathLike, table: Floats, times_of_scans: Callable[[], Floats] | None) -> Poses | None:
    """Poses of scans: row-major 3×4 matrices, one a scan, or behind the number of a scan; None where these are times."""
    numbers = table[:, 0] if table.shape[1] == 13 else np.arange(len(table))
    if table.shape[1] == 13 and (times_of_scans is None or not np.all((numbers >= 0) & (numbers < 1e7)
                                                                      & (numbers == np.floor(numbers)))):
        return None
    if times_of_scans is None:
        raise FormatError(path, "line 1", "12 columns are a pose of each scan without its time, and the recording's "
                                          "scans have none: begin each row with the time")
    times = times_of_scans()
    if table.shape[1] == 13 and numbers[0] <= times[-1] and numbers[-1] >= times[0]:
        return None
    if table.shape[1] == 12 and len(table) != len(times):
        raise FormatError(path, "", f"{len(table)} poses without times, but the recording has {len(times)} scans: begin "
                                    "each row with the time, or with the number of its scan")
    inside = numbers < len(times)
    poses = _of_matrices(times[numbers[inside].astype(int)], table[inside, -12:])
    if not 0 < len(poses.time_s) == np.count_nonzero(inside):
        raise FormatError(path, "", f"{np.count_nonzero(inside) - len(poses.time_s)} rows are no pose or have a time "
                                    "twice" if inside.any() else "no pose of a scan of the recording")
    return beyond_ends(poses)


def read_poses(path: PathLike, times_of_scans: Callable[[], Floats] | None = None, places_only: bool = False) -> Poses:
    """Reads a text file of poses, world from sensor; `#` begins a comment, commas are blanks.

    A line of names above the rows gives the order of time, position and quaternion, as in EuRoC's files, or of roll,
    pitch and yaw (with rad or deg in the line; beyond a revolution in radians they are degrees). Without one, the number of columns determines the
    format: 4 is `t x y z` (no rotation), 7 a HELIOS++ trajectory (`x y z t roll pitch yaw`, or `t roll pitch yaw x y z`
    where only that has rising times and angles; degrees), 8 TUM (`t x y z qx qy qz qw`), 13 a time and a row-major 3×4
    matrix, 12 the matrix alone. The rows of 12 columns are one a scan (KITTI, Ouster's and KISS-ICP's), and the first
    of 13 columns may be the numbers of scans instead of times. They then have the times that `times_of_scans` gives,
    and the motion goes on beyond the first and the last. With `places_only` no rotation is needed. Raises
    `FormatError`.
    """
    rows: list[list[float]] = []
    named: tuple[dict[str, int], int] = {}, 0
    head = ""
    with pathlib.Path(path).open(encoding="utf-8", errors="replace") as file:
        for number, line in enumerate(iter(lambda: file.readline(_LONGEST_LINE), ""), 1):
            words = line.partition("#")[0].replace(",", " ").split()
            if not rows:
                if not named[0]:
                    named, head = _named_columns(line), line.lower()
            try:
                values = [float(word) for word in words]
            except ValueError:
                if not rows and number == 1:
                    continue  # A line of column names.
                raise FormatError(path, f"line {number}", "is not a row of numbers") from None
            if values and rows and len(values) != len(rows[0]):
                raise FormatError(path, f"line {number}", f"{len(values)} columns instead of {len(rows[0])}")
            if values:
                rows.append(values)
    if not rows:
        raise FormatError(path, "", "no poses")
    table = np.array(rows)
    found, count = named
    whole = all(what in found for what in _QUATERNION)
    if found and (max(found.values()) < table.shape[1] if whole else count == table.shape[1]):
        poses = _ordered(table, found, places_only, path, head)
        if len(poses.time_s) < len(table):
            raise FormatError(path, "", f"{len(table) - len(poses.time_s)} rows are no pose or have a time twice")
        return poses
    if table.shape[1] in (16, 17) and np.all(table[:, -4:] == [0, 0, 0, 1]):
        table = table[:, :-4]  # The last rows of matrices of 4x4.
    table[:, 0] *= _seconds_of_dates(table[:, 0]) if table.shape[1] in (4, 8, 13) else 1.0
    none = np.tile([0.0, 0.0, 0.0, 1.0], (len(table), 1))
    if table.shape[1] == 4:
        poses = in_order(table[:, 0], table[:, 1:4], none)
    elif table.shape[1] == 7 and (why := _not_helios(table)):
        raise FormatError(path, "line 1", why)
    elif table.shape[1] == 7 and not _is_helios(table) and _is_helios(table[:, [4, 5, 6, 0, 1, 2, 3]]):
        poses = in_order(table[:, 0], table[:, 4:], from_angles(*np.deg2rad(table[:, 1:4]).T))
    elif table.shape[1] == 7:
        poses = in_order(table[:, 3], table[:, :3], from_angles(*np.deg2rad(table[:, 4:]).T))
    elif table.shape[1] == 8:
        poses = in_order(table[:, 0], table[:, 1:4], table[:, 4:])
    elif table.shape[1] in (12, 13):
        of_scans = _of_scans(path, table, times_of_scans)
        if of_scans is not None:
            return of_scans
        poses = _of_matrices(table[:, 0], table[:, 1:])
    else:
        raise FormatError(path, "line 1", f"{table.shape[1]} columns: poses have 4, 7, 8, 12, 13, 16 or 17")
    if len(poses.time_s) < len(table):
        raise FormatError(path, "", f"{len(table) - len(poses.time_s)} rows are no pose or have a time twice")
    return poses
