"""Scans in the world: laws of interpolation, de-skewing against the closed form, misses and what is left out."""
from __future__ import annotations

import collections
import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from format_data import data, end_points, generated_log, straight_path

from underbrush.formats import FormatError, Poses, Scan, beams, open_recording, place, read_poses
from underbrush.formats.place import directions_of_misses
from underbrush.formats.trajectory import (compose, conjugate, from_angles, from_matrices, in_order, multiply, pose_at,
                                           rotate, slerp)


def random_turns(n: int, seed: int = 3) -> np.ndarray:
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def matrices(q: npt.NDArray[Any]) -> np.ndarray:
    return np.stack([rotate(q, np.tile(axis, (len(q), 1))) for axis in np.eye(3)], axis=-1)


def test_rotations_agree_with_matrices() -> None:
    a, b = random_turns(50), random_turns(50, 4)
    np.testing.assert_allclose(matrices(multiply(a, b)), matrices(a) @ matrices(b), atol=1e-14)
    np.testing.assert_allclose(matrices(conjugate(a)), np.swapaxes(matrices(a), 1, 2), atol=1e-14)
    again = from_matrices(matrices(a))
    np.testing.assert_allclose(np.abs(np.sum(again * a, axis=1)), 1, atol=1e-14)


def test_slerp_turns_at_a_constant_rate() -> None:
    a = random_turns(20)
    turn = from_angles(np.zeros(20), np.zeros(20), np.full(20, 1.2))
    for share in (0.0, 0.25, 1.0):
        part = from_angles(np.zeros(20), np.zeros(20), np.full(20, 1.2 * share))
        for sign in (1, -1):  # Both quaternions of a rotation are the same rotation.
            found = slerp(a, sign * multiply(a, turn), np.full(20, share))
            np.testing.assert_allclose(np.abs(np.sum(found * multiply(a, part), axis=1)), 1, atol=1e-12)
    close = multiply(a, from_angles(np.zeros(20), np.zeros(20), np.full(20, 1e-9)))
    assert np.isfinite(slerp(a, close, np.full(20, 0.5))).all()


def test_poses_of_a_chain() -> None:
    outer, inner = straight_path(0, 1), straight_path(0.25, 2, 30)
    both = compose(outer, inner)
    assert both.time_s[0] == pytest.approx(0.25) and both.time_s[-1] == pytest.approx(1)
    p, q, _ = pose_at(outer, both.time_s)
    a, b, _ = pose_at(inner, both.time_s)
    np.testing.assert_allclose(both.position, p + rotate(q, a), atol=1e-9)
    np.testing.assert_allclose(both.rotation, multiply(q, b), atol=1e-12)


def test_order_of_poses() -> None:
    time = np.array([3.0, 1.0, 2.0, 2.0, np.nan])
    poses = in_order(time, np.arange(15.0).reshape(5, 3), np.tile([0, 0, 0, 1.0], (5, 1)))
    assert poses.time_s.tolist() == [1, 2, 3] and poses.position[1].tolist() == [9, 10, 11]


def moving_scan() -> tuple[Scan, Poses, dict[str, npt.NDArray[Any]]]:
    """A scan in the sensor's frame, its poses, and its beams in the world."""
    log, poses = generated_log(scans=1, misses=False)
    position, rotation, _ = pose_at(poses, log["time_s"])
    xyz = rotate(conjugate(rotation), end_points(log) - position)
    return Scan(4, 0.0, xyz=xyz, beam_time_s=log["time_s"], intensity=log["intensity"], ring=log["ring"]), poses, log


def test_each_beam_has_the_pose_of_its_own_time() -> None:
    scan, poses, log = moving_scan()
    back = place(scan, poses)
    for name, kind in (("origin", "f8"), ("direction", "f4"), ("range_m", "f4"), ("intensity", "f4"), ("time_s", "f8"),
                       ("ring", "u2"), ("scan", "u4"), ("packet", "u4"), ("flags", "u1")):
        assert back[name].dtype == kind and len(back[name]) == len(scan)
    np.testing.assert_allclose(back["origin"], log["origin"], atol=1e-9)
    np.testing.assert_allclose(back["direction"], log["direction"], atol=2e-7)
    np.testing.assert_allclose(end_points(back), end_points(log), atol=2e-5)
    assert set(back["scan"]) == {4} and back["packet"].max() == 99
    smeared = place(scan, Poses(poses.time_s[:1], poses.position[:1], poses.rotation[:1]))
    assert np.abs(end_points(smeared) - end_points(log)).max() > 0.1  # Without the motion it would be wrong.


def test_order_of_time_whatever_the_order_of_rows() -> None:
    scan, poses, _ = moving_scan()
    rows = np.random.default_rng(5).permutation(len(scan))
    mixed = Scan(4, 0.0, xyz=scan.xyz[rows], beam_time_s=scan.beam_time_s[rows], ring=scan.ring[rows])  # type: ignore
    a, b = place(scan, poses), place(mixed, poses)
    assert np.all(np.diff(b["time_s"]) >= 0)
    for c in (a, b):
        c["order"] = np.lexsort((c["ring"], c["time_s"]))
    np.testing.assert_array_equal(a["range_m"][a["order"]], b["range_m"][b["order"]])


def test_what_cannot_be_placed_is_counted() -> None:
    scan, poses, _ = moving_scan()
    assert scan.xyz is not None
    scan.xyz[0] = np.nan
    scan.xyz[5] = 0
    short = Poses(poses.time_s[:6], poses.position[:6], poses.rotation[:6])
    skipped: collections.Counter[str] = collections.Counter()
    back = place(scan, short, skipped=skipped)
    assert skipped["misses whose direction cannot be found"] == 1 and skipped["points at the sensor itself"] == 1
    assert len(back["range_m"]) + sum(skipped.values()) == len(scan)
    assert skipped["beams outside the times of the poses"] > 0
    with pytest.raises(ValueError, match="neither poses nor a position"):
        place(scan, None)


@pytest.mark.parametrize(("moves_m", "lost"), [(0.0, 0), (20.0, 176)])
def test_beams_in_gaps_of_the_poses_are_counted(moves_m: float, lost: int) -> None:
    """Odometry of 50 Hz that stops for 1.8 s: where the sensor was is not known, unless it stood."""
    time_s = np.concatenate([np.arange(0, 1, 0.02), np.arange(2.78, 4, 0.02)])
    position = np.column_stack([np.where(time_s > 1, moves_m, 0), np.zeros((len(time_s), 2))])
    poses = Poses(time_s, position, np.tile([0, 0, 0, 1.0], (len(time_s), 1)))
    beam_time_s = np.arange(0.005, 3.9, 0.01)
    scan = Scan(0, 0.0, xyz=np.tile([5.0, 0, 0], (len(beam_time_s), 1)), beam_time_s=beam_time_s)
    skipped: collections.Counter[str] = collections.Counter()
    back = place(scan, poses, skipped=skipped)
    assert len(back["range_m"]) + lost == len(beam_time_s)
    assert dict(skipped) == ({"beams in gaps of the poses": lost} if lost else {})
    inside = (beam_time_s > 1.0) & (beam_time_s < 2.76)
    np.testing.assert_allclose(back["time_s"], beam_time_s[~inside] if lost else beam_time_s)
    assert poses.in_gaps(np.array([-1.0, 0.99, 1.01, 2.75, 2.77, 9])).tolist() == [False, False, *[lost > 0] * 2, False, False]


def test_world_coordinates_need_only_the_position() -> None:
    rng = np.random.default_rng(7)
    time = np.sort(rng.uniform(0, 1, 500))
    xyz = rng.uniform(-100, 100, (500, 3)) + [5e5, 4e6, 0]
    poses = straight_path()
    back = place(Scan(0, 0.0, xyz=xyz, beam_time_s=time), poses, world=True)
    np.testing.assert_allclose(back["origin"], pose_at(poses, time)[0])
    np.testing.assert_allclose(end_points(back), xyz, atol=3e-5)
    tripod = place(Scan(0, 0.0, xyz=xyz), None, world=True, position=(5e5, 4e6, 1.7))
    assert np.all(tripod["origin"] == [5e5, 4e6, 1.7])
    np.testing.assert_allclose(end_points(tripod), xyz, atol=3e-5)


def angle(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> np.ndarray:
    return np.asarray(np.rad2deg(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1))))


@pytest.mark.parametrize("by_firing", [False, True])
def test_directions_of_misses_in_a_grid(by_firing: bool) -> None:
    rings, columns = 32, 360
    azimuth = -np.deg2rad(np.arange(columns))[None, :] + np.deg2rad(np.tile([3.2, 1.0, -1.0, -3.2], 8))[:, None] + 2.0
    elevation = np.deg2rad(np.linspace(20, -20, rings))[:, None] + 0 * azimuth
    d = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1)
    rng = np.random.default_rng(11)
    xyz = d * rng.uniform(2, 50, (rings, columns, 1))
    miss = rng.random((rings, columns)) < 0.4
    miss[:, 100:180] = True  # The open sky on one side,
    miss[[0, 17, 31]] = True  # rings without any return,
    xyz[miss] = np.nan
    ring = np.repeat(np.arange(rings), columns).reshape(rings, columns).astype(np.uint16)
    if by_firing:
        xyz, d, ring, miss = xyz.swapaxes(0, 1), d.swapaxes(0, 1), ring.T, miss.T
    scan = Scan(0, 0.0, xyz=xyz.reshape(-1, 3), ring=ring.reshape(-1), shape=(xyz.shape[0], xyz.shape[1]))
    error = angle(directions_of_misses(scan), d.reshape(-1, 3))
    without = np.isin(ring.reshape(-1), [0, 17, 31])
    assert error[~without].max() < 1e-6
    assert error[without].max() < 7  # Their offsets from the column are those of other rings.


def test_directions_of_hidden_returns_of_a_real_scan() -> None:
    cloud = np.load(data("marv_forest", "1727353472_601360559.npz"))["cloud"].reshape(-1)
    true = np.stack([cloud[name] for name in "xyz"], -1).astype(np.float64)
    hit = np.isfinite(true[:, 0])
    hidden = hit & (np.random.default_rng(13).random(len(true)) < 0.2) & (np.nan_to_num(true) ** 2).sum(1).__gt__(9)
    seen = true.copy()
    seen[hidden] = np.nan
    scan = Scan(0, 0.0, xyz=seen, ring=np.repeat(np.arange(128), 1024).astype(np.uint16), shape=(128, 1024))
    found = directions_of_misses(scan)
    assert np.isfinite(found).all()
    error = angle(found[hidden], true[hidden] / np.linalg.norm(true[hidden], axis=1, keepdims=True))
    assert np.median(error) < 0.1 and np.quantile(error, 0.95) < 0.5


def test_no_grid_no_directions() -> None:
    rng = np.random.default_rng(17)
    xyz = rng.normal(size=(400, 3))
    xyz[::7] = np.nan
    assert np.isnan(directions_of_misses(Scan(0, 0.0, xyz=xyz, shape=(20, 20)))).all()
    assert np.isnan(directions_of_misses(Scan(0, 0.0, xyz=xyz))).all()


def test_files_of_poses(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "poses.txt"
    s = np.sqrt(0.5)
    for text in (f"# TUM\n1 4 5 6 0 0 {s} {s}\n0 1 2 3 0 0 0 1\n",
                 "0 1 0 0 1 0 1 0 2 0 0 1 3\n1, 0, -1, 0, 4, 1, 0, 0, 5, 0, 0, 1, 6\n",
                 "1 2 3 0 0 0 0\n4 5 6 1 0 0 90\n"):
        path.write_text(text)
        poses = read_poses(path)
        assert poses.time_s.tolist() == [0, 1]
        np.testing.assert_allclose(poses.position, [[1, 2, 3], [4, 5, 6]])
        np.testing.assert_allclose(poses.rotation, [[0, 0, 0, 1], [0, 0, s, s]], atol=1e-12)
    path.write_text("time,x,y,z\n0,1,2,3\n1,4,5,6\n")
    assert read_poses(path).position[1].tolist() == [4, 5, 6]
    for text in ("", "1 2 3\n", "0 1 2 3\n1 2\n", "0 1 2 3\n0 1 2 3\n", "0 1 2 3 0 0 0 2\n",
                 "0 1 0 0 1 0 1 0 2 0 1 1 3\n", "0 1 x 3\n0 1 x 3\n"):
        path.write_text(text)
        with pytest.raises(FormatError):
            read_poses(path)


@pytest.mark.parametrize(("text", "turns"), [
    ("# x y z time\n1 2 3 10\n4 5 6 11\n", False), ("Easting;Northing;Height;GPSTime\n1,2,3,10\n4,5,6,11\n", False),
    ("time,x,y,z,roll,pitch,yaw\n10,1,2,3,0,0,0\n11,4,5,6,0,0,90\n", True),
    ("t r p y x y z\n10 0 0 0 1 2 3\n11 0 0 90 4 5 6\n", True),
    ("# time, x, y, z, roll [rad], pitch [rad], yaw [rad]\n10,1,2,3,0,0,0\n11,4,5,6,0,0,1.5707963267948966\n", True),
    ("#sec,nsec,x,y,z,qw,qx,qy,qz\n9,1000000000,1,2,3,1,0,0,0\n10,1e9,4,5,6,0.70710678,0,0,0.70710678\n", True),
    ("10 0 0 359 1000 2 3\n11 0 0 90 1003 5 6\n", True), ("1 2 3 10 0 0 0\n4 5 6 11 0 0 90\n", True)])
def test_named_columns_of_poses(tmp_path: pathlib.Path, text: str, turns: bool) -> None:
    path, s = tmp_path / "poses.txt", np.sqrt(0.5)
    path.write_text(text)
    poses = read_poses(path)
    far = 999.0 if "1000" in text and "1000000" not in text else 0.0
    assert poses.time_s.tolist() == [10, 11]
    np.testing.assert_allclose(poses.position, [[1 + far, 2, 3], [4 + far, 5, 6]])
    if turns:
        np.testing.assert_allclose(np.abs(poses.rotation[1]), [0, 0, s, s], atol=1e-8)


def test_named_columns_without_a_rotation(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "poses.txt"
    for text, why in (("GPSTime,Easting,Northing,Height,Roll,Pitch,Heading\n10,1,2,3,0,0,45\n11,4,5,6,0,0,45\n",
                       "angles of an aircraft"), ("time,x,y,z,speed\n10,1,2,3,9\n11,4,5,6,9\n", "names no rotation")):
        path.write_text(text)
        assert read_poses(path, places_only=True).position.tolist() == [[1, 2, 3], [4, 5, 6]]
        with pytest.raises(FormatError, match=why):
            read_poses(path)


def test_beams_are_in_order_of_time_and_those_of_equal_time_in_their_own() -> None:
    """For few times, for many, and for times that are no numbers, whatever their bits."""
    draw = np.random.default_rng(7)
    strange = np.array([0xfff8000000000000, 0x7ff8000000000001], np.uint64).view(np.float64)
    for pool in (np.arange(5.0), draw.random(4000), np.concatenate([[0.0, -0.0, 1.0, np.inf, -np.inf], strange])):
        time = draw.choice(pool, 3000)
        scan = Scan(0, 0.0, xyz=draw.normal(size=(3000, 3)) + 5, beam_time_s=time, extra={"row": np.arange(3000)})
        with np.errstate(invalid="ignore"):
            found = place(scan, None, position=[0, 0, 0])
        assert np.array_equal(found["row"], np.argsort(time, kind="stable"))
        assert np.allclose(found["direction"] * found["range_m"][:, None], scan.xyz[found["row"]], atol=1e-5)


def test_a_row_with_part_of_a_place_is_a_miss() -> None:
    azimuth, elevation = np.meshgrid(np.linspace(0, 6, 100), np.deg2rad([-10.0, 0, 10, 20]))
    xyz = 9 * np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1)
    whole, rows = xyz.reshape(-1, 3), [30, 170, 390]
    broken = whole.copy()
    broken[rows, 2] = np.nan
    found = place(Scan(0, 0.0, xyz=broken, shape=(4, 100)), None, position=(0.0, 0.0, 0.0))
    assert len(found["range_m"]) == 400 and np.flatnonzero(np.isinf(found["range_m"])).tolist() == rows
    assert np.allclose(found["direction"], whole / 9, atol=2e-3)


@pytest.mark.parametrize(("text", "reason"), [
    ("1 2 3 0 0 0 1\n2 2 3 0 0 0 1\n", "have no times"),
    ("0 1 2 3 0 0 0\n1 2 3 3 0 0 5\n", "t roll pitch yaw x y z or t x y z roll pitch yaw"),
    ("t,x,y,z,roll,pitch,yaw\n0,1,2,3,0,0,1.5\n1,4,5,6,0,0,1.5\n", "radians or degrees")])
def test_columns_that_may_be_others_are_asked_for(tmp_path: pathlib.Path, text: str, reason: str) -> None:
    (tmp_path / "p.txt").write_text(text)
    with pytest.raises(FormatError, match=reason):
        read_poses(tmp_path / "p.txt")


def test_square_matrices(tmp_path: pathlib.Path) -> None:
    (tmp_path / "p.txt").write_text("9 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n")
    poses = read_poses(tmp_path / "p.txt")
    assert poses.time_s.tolist() == [9] and poses.position.tolist() == [[5, 6, 7]]


def test_a_sensor_that_moves_has_no_single_position(tmp_path: pathlib.Path) -> None:
    """Its poses and a position cannot both be right; for one station of several the position is taken, and its turn."""
    pye57 = pytest.importorskip("pye57", reason="pye57 is not installed: pip install 'underbrush[formats]'")
    file = pye57.E57(str(tmp_path / "a.e57"), mode="w")
    half = np.sqrt(0.5)
    for k in range(2):
        xyz = np.random.default_rng(k).normal(size=(500, 3)) * 5
        file.write_scan_raw({**{f"cartesian{axis}": xyz[:, n] for n, axis in enumerate("XYZ")}}, name=f"S{k}",
                            rotation=np.array([half, 0, 0, half] if k else [1.0, 0, 0, 0]), translation=np.array([20.0 * k, 0, 1.5]))
    file.close()
    with pytest.raises(ValueError, match=r"moves by 20.0 m, and --position is for one that stands still"):
        list(beams(open_recording(tmp_path / "a.e57"), position=[5, 5, 2]))
    back = list(beams(open_recording(tmp_path / "a.e57", topic="S1"), position=[5, 5, 2]))
    assert len(back) == 1 and (back[0]["origin"] == [5, 5, 2]).all()
    np.testing.assert_allclose(end_points(back[0]), np.stack([-xyz[:, 1], xyz[:, 0], xyz[:, 2]], axis=1) + [5, 5, 2],
                               atol=1e-4)  # A quarter of a revolution to the left.
    turning = Poses(np.arange(2.0), np.zeros((2, 3)), np.array([[0, 0, 0, 1.0], [0, 0, half, half]]))
    with pytest.raises(ValueError, match="turns by 90°, and --position"):
        list(beams(open_recording(tmp_path / "a.e57", topic="S1"), poses=turning, position=[5, 5, 2]))
    with pytest.raises(FormatError, match=r"^[^:]*a.e57: header: no station 'S9': 0 S0, 1 S1$"):
        open_recording(tmp_path / "a.e57", topic="S9")
