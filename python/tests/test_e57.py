"""E57: stations, poses, misses with and without a direction."""
from __future__ import annotations

import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pye57 = pytest.importorskip("pye57", reason="pye57 is not installed: pip install 'underbrush[formats]'")

from format_data import end_points  # noqa: E402

from underbrush.formats import FormatError, beams, open_recording  # noqa: E402
from underbrush.import_recording import run  # noqa: E402


def written(path: pathlib.Path, stations: int = 2) -> list[npt.NDArray[Any]]:
    """Writes stations; every 7th row is a miss of state 1, every 11th one of state 2. Returns the points."""
    rng = np.random.default_rng(2)
    file = pye57.E57(str(path), mode="w")
    clouds = []
    for k in range(stations):
        n = 2000 + k
        xyz = rng.normal(size=(n, 3)) * 10
        state = np.zeros(n, np.int8)
        state[::7], state[::11] = 1, 2
        clouds.append(xyz)
        half = 0.25 * k
        file.write_scan_raw(
            {"cartesianX": xyz[:, 0], "cartesianY": xyz[:, 1], "cartesianZ": xyz[:, 2], "cartesianInvalidState": state,
             "intensity": np.arange(n, dtype=np.float32), "rowIndex": np.arange(n) % 40,
             "columnIndex": np.arange(n) // 40},
            rotation=np.array([np.cos(half), 0, 0, np.sin(half)]), translation=np.array([100.0 * k, 5, 1.5]))
    file.close()
    return clouds


def test_stations_in_the_world(tmp_path: pathlib.Path) -> None:
    clouds = written(tmp_path / "stations.e57")
    recording = open_recording(tmp_path / "stations.e57")
    assert recording.organised and len(recording.found()) == 4
    placed = list(beams(recording))
    assert len(placed) == 2 and recording.bytes_done == recording.bytes_total
    lost = np.intp(0)
    for k, (cloud, back) in enumerate(zip(clouds, placed)):
        rows = np.arange(len(cloud))
        directed = rows % 11 != 0
        hit = directed & (rows % 7 != 0)
        lost += np.count_nonzero(~directed)
        np.testing.assert_array_equal(np.isfinite(back["range_m"]), hit[directed])
        c, s = np.cos(0.5 * k), np.sin(0.5 * k)
        turned = cloud @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        np.testing.assert_allclose(end_points(back), turned[hit] + [100 * k, 5, 1.5], atol=1e-4)
        np.testing.assert_allclose(back["direction"], (turned / np.linalg.norm(turned, axis=1)[:, None])[directed],
                                   atol=1e-6)
        np.testing.assert_array_equal(back["row"], rows[directed] % 40)
        assert set(back["station"]) == {k}
    assert recording.skipped == {"beams without a point or a direction": lost}


def test_damaged_files_are_refused(tmp_path: pathlib.Path) -> None:
    written(tmp_path / "good.e57")
    good = (tmp_path / "good.e57").read_bytes()
    for content in (good[:100], good[:len(good) // 2], good[:3000] + bytes(2000) + good[5000:]):
        (tmp_path / "bad.e57").write_bytes(content)
        with pytest.raises(FormatError, match=r"^[^\n]*bad\.e57: [^\n]*$"):
            list(open_recording(tmp_path / "bad.e57").scans())
    assert (tmp_path / "bad.e57").exists()


@pytest.mark.parametrize("name", ["1", "Station B"])
def test_one_station_by_number_or_name(tmp_path: pathlib.Path, name: str) -> None:
    file = pye57.E57(str(tmp_path / "named.e57"), mode="w")
    points = np.random.default_rng(1).normal(size=(3, 200, 3))
    for k, title in enumerate(("A", "Station B", "0")):
        file.write_scan_raw({f"cartesian{axis}": points[k, :, n] for n, axis in enumerate("XYZ")}, name=title,
                            translation=np.array([10.0 * k, 0, 0]))
    file.close()
    back = list(beams(open_recording(tmp_path / "named.e57", topic=name)))
    assert len(back) == 1 and set(back[0]["station"]) == {1}
    np.testing.assert_allclose(end_points(back[0]), points[1] + [10, 0, 0], atol=1e-4)
    assert set(next(beams(open_recording(tmp_path / "named.e57", topic="0")))["station"]) == {2}  # Names come first.
    with pytest.raises(ValueError, match="named.e57: header: no station 'C': 0 A, 1 Station B, 2 0"):
        open_recording(tmp_path / "named.e57", topic="C")


def test_a_row_of_poses_for_each_station(tmp_path: pathlib.Path) -> None:
    clouds = written(tmp_path / "stations.e57")
    (tmp_path / "poses.txt").write_text("1 0 0 7 0 1 0 8 0 0 1 9\n1 0 0 70 0 1 0 8 0 0 1 9\n")
    back = list(beams(open_recording(tmp_path / "stations.e57", poses=tmp_path / "poses.txt")))
    np.testing.assert_allclose([piece["origin"][0] for piece in back], [[7, 8, 9], [70, 8, 9]])
    assert len(back) == len(clouds)


def station(file: Any, points: npt.NDArray[Any], place: npt.NDArray[Any], half: float = 0.0) -> None:
    file.write_scan_raw({f"cartesian{axis}": points[:, n] for n, axis in enumerate("XYZ")}, translation=place,
                        rotation=np.array([np.cos(half), 0, 0, np.sin(half)]))


def test_points_of_the_world_with_a_pose_are_not_moved_again(tmp_path: pathlib.Path) -> None:
    place = np.array([532100.0, 5412300.0, 311.8])
    world = place + np.random.default_rng(4).normal(size=(500, 3)) * 20
    file = pye57.E57(str(tmp_path / "a.e57"), mode="w")
    station(file, world, place, 0.4)
    file.close()
    recording = open_recording(tmp_path / "a.e57")
    back = next(beams(recording))
    np.testing.assert_allclose(end_points(back), world, atol=1e-4)
    assert np.all(back["origin"] == place)
    note, = recording.notes()  # type: ignore[attr-defined]
    assert "the coordinates of the world already" in note


def test_points_that_no_station_can_see_are_refused(tmp_path: pathlib.Path) -> None:
    place = np.array([532100.0, 5412300.0, 311.8])
    near = np.random.default_rng(4).normal(size=(500, 3)) * 20
    for name, parts, why in (("far", [(near + place, [1, 2, 3])], "5438 km from the scanner"),
                             ("mixed", [(near, place), (near + place, place)], "read one with --topic 1")):
        file = pye57.E57(str(tmp_path / name), mode="w")
        for points, pose in parts:
            station(file, points, np.array(pose, float))
        file.close()
        with pytest.raises(FormatError, match=f"{name}: station {len(parts) - 1}: .*{why}"):
            list(beams(open_recording(tmp_path / name)))
    for topic in "01":
        back, = beams(open_recording(tmp_path / "mixed", topic=topic))
        np.testing.assert_allclose(end_points(back), near + place, atol=1e-4)


def test_a_cliff_far_away_is_no_world(tmp_path: pathlib.Path) -> None:
    place = np.array([532100.0, 5412300.0, 311.8])
    cliff = np.random.default_rng(4).normal(size=(500, 3)) * 20 + [0, 1500, 100]
    file = pye57.E57(str(tmp_path / "a.e57"), mode="w")
    station(file, cliff, place)
    file.close()
    recording = open_recording(tmp_path / "a.e57")
    np.testing.assert_allclose(end_points(next(beams(recording))), cliff + place, atol=1e-3)
    assert not recording.notes()  # type: ignore[attr-defined]


def test_stations_without_poses_are_said_to_stand_at_the_origin(tmp_path: pathlib.Path) -> None:
    file = pye57.E57(str(tmp_path / "a.e57"), mode="w")
    station(file, np.random.default_rng(4).normal(size=(500, 3)) * 20, np.zeros(3))
    file.close()
    recording = open_recording(tmp_path / "a.e57")
    assert np.all(next(beams(recording))["origin"] == 0)
    assert "stand at the origin" in recording.notes()[0]  # type: ignore[attr-defined]


def test_stations_in_mm(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A warning names the option with which they are those in m."""
    points = np.random.default_rng(4).normal(size=(500, 3)) * [9, 9, 1]
    for name, unit in (("m.e57", 1.0), ("mm.e57", 1e3)):
        file = pye57.E57(str(tmp_path / name), mode="w")
        station(file, unit * points, unit * np.array([5, 6, 1.5]), 0.2)
        file.close()
    assert run([str(tmp_path / "mm.e57"), "-o", str(tmp_path / "log.ply")]) == 0
    assert "--unit mm" in capsys.readouterr().err
    right = end_points(next(beams(open_recording(tmp_path / "m.e57"))))
    np.testing.assert_allclose(end_points(next(beams(open_recording(tmp_path / "mm.e57", unit="mm")))), right, atol=1e-3)
    assert run([str(tmp_path / "m.e57"), "-o", str(tmp_path / "log.ply"), "--force"]) == 0
    assert not capsys.readouterr().err


def test_angles_in_degrees_are_refused(tmp_path: pathlib.Path) -> None:
    written(tmp_path / "a.e57", 1)
    recording: Any = open_recording(tmp_path / "a.e57")
    for azimuth, elevation in ((190.0, 0.1), (0.5, 30.0)):
        with pytest.raises(FormatError, match="station 0: angles beyond a turn in radians: are they in degrees"):
            recording._scan({"sphericalRange": np.full(9, 5.0), "sphericalAzimuth": np.full(9, azimuth),
                             "sphericalElevation": np.full(9, elevation)}, 0, 0)
