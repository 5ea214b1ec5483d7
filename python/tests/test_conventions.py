"""Conventions of people's own files: units of times, orders of columns, coordinates of a world, unit vectors."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

import underbrush
from underbrush import import_recording
from underbrush.formats import FormatError, OptionMissing, beams, open_recording, read_poses
from underbrush.formats.point_times import PointTimes

CASES = pathlib.Path(__file__).resolve().parents[2] / "tests" / "cases"
SCAN = CASES / "common_options" / "scan.las"
PLACE = ("--position", "532100,5412300,311.8")


@pytest.mark.parametrize("period", [0.05, 0.1, 1.0])
@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e-6, 1e-9])
def test_the_unit_is_that_which_fits_the_scan(period: float, unit: float) -> None:
    seconds = np.linspace(0, 0.97 * period, 101)
    column = np.rint(seconds / unit).astype(np.uint32) if unit < 1e-3 else seconds / unit
    times = PointTimes("f", period)
    np.testing.assert_allclose(times.seconds("t", column, 5.0), seconds + 5, atol=2 * unit if unit < 1e-3 else 1e-9)
    assert bool(times.note) == (unit in (1e-3, 1e-6))


def test_times_that_fit_no_unit_are_refused() -> None:
    with pytest.raises(FormatError, match="neither"):
        PointTimes("f", 0.1).seconds("t", np.linspace(0, 3.3, 31), 0.0)
    share = PointTimes("f", 0.1)
    assert share.seconds("t", np.linspace(0, 0.97, 31), 0.0)[-1] == pytest.approx(0.097)
    assert "shares" in share.note


def test_poses_follow_their_header(tmp_path: pathlib.Path) -> None:
    (tmp_path / "p.csv").write_text("#timestamp, p_RS_R_x [m], p_y [m], p_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
                                    "q_RS_z [], v_x [m s^-1]\n1403636580838555648,1,2,3,0.8,0,0,0.6,9\n")
    poses = read_poses(tmp_path / "p.csv")
    np.testing.assert_allclose(poses.rotation, [[0, 0, 0.6, 0.8]])
    assert poses.time_s[0] == pytest.approx(1403636580.838555648, abs=1e-6)


def test_an_e57_without_a_pose_in_coordinates_of_a_world_is_asked_for_its_place(tmp_path: pathlib.Path) -> None:
    pye57 = pytest.importorskip("pye57", reason="pye57 is not installed: pip install 'underbrush[formats]'")
    place, rng = np.array([532100.0, 5412300.0, 311.8]), np.random.default_rng(1)
    away = rng.normal(size=(500, 3)) * 10
    file = pye57.E57(str(tmp_path / "utm.e57"), mode="w")
    header = {name: (place + away)[:, k] for k, name in enumerate(("cartesianX", "cartesianY", "cartesianZ"))}
    file.write_scan_raw(header)
    file.close()
    recording = open_recording(tmp_path / "utm.e57")
    assert recording.world
    with pytest.raises(OptionMissing, match="--position"):
        next(iter(beams(recording)))
    (placed,) = beams(open_recording(tmp_path / "utm.e57"), position=place.tolist())
    np.testing.assert_allclose(np.sort(placed["range_m"]), np.sort(np.linalg.norm(away, axis=1)), atol=1)  # float32


@pytest.mark.parametrize("bad", [[2.0, 0, 0], [0.0, 0, 0], [np.nan, 0, 0]])
def test_directions_are_unit_vectors(bad: list[float], tmp_path: pathlib.Path) -> None:
    good = {"origin": np.zeros((2, 3)), "direction": np.array([[1.0, 0, 0], [0, 1, 0]]), "range_m": np.array([3, 4.0])}
    log = underbrush.log_from_columns(**good)
    with pytest.raises(ValueError, match="row 1"):
        underbrush.log_from_columns(**{**good, "direction": np.array([[1.0, 0, 0], bad])})
    with pytest.raises(ValueError, match="range of row 0"):
        underbrush.log_from_columns(**{**good, "range_m": np.array([-1.0, 2])})
    log.direction[1] = bad
    with pytest.raises(ValueError, match="row 1"):
        underbrush.write_log(tmp_path / "log.ply", log)
    assert not (tmp_path / "log.ply").exists()


def test_a_log_reaches_as_far_as_its_longest_return(tmp_path: pathlib.Path) -> None:
    far = ("--position", "532100,5412300,900")
    assert import_recording.run([str(SCAN), *far, "-o", str(tmp_path / "log.ply")]) == 0
    with_limit = underbrush.read_log(tmp_path / "log.ply")
    assert 500 < with_limit.range_m.max() <= with_limit.info.max_range_m < with_limit.range_m.max() + 1
    assert import_recording.run([str(SCAN), *far, "--max-range", "750", "-o", str(tmp_path / "log.ply")]) == 0
    assert underbrush.read_log(tmp_path / "log.ply").info.max_range_m == 750


def test_no_output_replaces_a_users_file(tmp_path: pathlib.Path) -> None:
    notes = tmp_path / "notes.txt"
    notes.write_text("mine\n")
    for words in (["-o", str(notes)], ["-o", str(tmp_path / "log.ply"), "--json", str(notes)]):
        assert import_recording.run([str(SCAN), *PLACE, *words]) == 4
        assert notes.read_text() == "mine\n"
    assert import_recording.run([str(SCAN), *PLACE, "-o", str(SCAN), "--force"]) == 2
    for _ in range(2):  # What Underbrush wrote may be replaced.
        assert import_recording.run([str(SCAN), *PLACE, "-o", str(tmp_path / "log.ply")]) == 0
