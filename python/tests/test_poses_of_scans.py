"""Poses without times, one a scan (KITTI's and Ouster's 12 columns), and the numbers of scans before them."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

import test_ouster as ouster
from packet_files import T0
from underbrush.formats import FormatError, beams, open_recording, read_poses
from underbrush.formats.trajectory import from_angles
from underbrush.import_recording import run

SPEED, TURN = 10.0, 0.5  #: m/s along x, rad/s about z.


def line(time_s: float) -> str:
    """The row-major 3×4 matrix of the sensor at a time after T0."""
    c, s = np.cos(TURN * time_s), np.sin(TURN * time_s)
    return f"{c} {-s} 0 {SPEED * time_s} {s} {c} 0 2 0 0 1 1.5"


#: Columns of a frame are sent at 0, 1/64, …, 63/64 of a tenth of a second.
MIDDLES = [0.1 * (k + 0.5 * 63 / 64) for k in range(4)]


def capture(folder: pathlib.Path) -> pathlib.Path:
    return ouster.save(folder, ouster.packets("LEGACY", [7, 8, 9, 10]), ouster.meta("LEGACY"))


@pytest.mark.parametrize("numbered", [False, True])
def test_a_row_a_scan_is_the_pose_of_its_middle(tmp_path: pathlib.Path, numbered: bool) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text("".join((f"{k} " if numbered else "") + line(t) + "\n" for k, t in enumerate(MIDDLES)))
    recording = open_recording(capture(tmp_path), poses=poses)
    back = {name: np.concatenate([piece[name] for piece in beams(recording)]) for name in ("origin", "direction", "time_s")}
    assert not recording.skipped and len(back["time_s"]) == 4 * 64 * 32  # Also what lies beyond the first and last row.
    after = back["time_s"] - T0
    # Beams begin up to 66 mm from the sensor's origin.
    away = back["origin"] - np.column_stack([SPEED * after, np.full(len(after), 2), np.full(len(after), 1.5)])
    assert np.linalg.norm(away, axis=1).max() < 0.07
    turned = from_angles(0 * after, 0 * after, TURN * after)
    beam = np.tile(ouster.DIRECTION.reshape(-1, 3), (4, 1))
    from underbrush.formats.trajectory import rotate
    np.testing.assert_allclose(back["direction"], rotate(turned, beam), atol=1e-5)


def test_scans_without_a_number_have_poses_between(tmp_path: pathlib.Path) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text("".join(f"{k} {line(MIDDLES[k])}\n" for k in (0, 3)))
    back = list(beams(open_recording(capture(tmp_path), poses=poses)))
    along = back[1]["origin"][:, 0] - SPEED * (back[1]["time_s"] - T0)
    assert np.abs(along).max() < 0.07


def test_times_before_matrices_stay_times(tmp_path: pathlib.Path) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text("".join(f"{T0 + t} {line(t)}\n" for t in (-1.0, 0.0, 1.0)))
    back = next(beams(open_recording(capture(tmp_path), poses=poses)))
    assert np.abs(back["origin"][:, 0] - SPEED * (back["time_s"] - T0)).max() < 0.07
    np.testing.assert_allclose(read_poses(poses).time_s, [T0 - 1, T0, T0 + 1])


def test_another_number_of_rows_is_refused(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text("".join(line(t) + "\n" for t in MIDDLES[:3]))
    path = capture(tmp_path)
    assert run([str(path), "--poses", str(poses), "-o", str(tmp_path / "log.ply")]) == 3
    said = capsys.readouterr().err
    assert "poses.txt: 3 poses without times, but the recording has 4 scans: begin each row with the time" in said
    poses.write_text("".join(line(t) + "\n" for t in MIDDLES))
    assert run([str(path), "--poses", str(poses), "-o", str(tmp_path / "log.ply")]) == 0
    las = pathlib.Path(__file__).resolve().parents[2] / "tests/cases/common_options/scan.las"
    assert run([str(las), "--poses", str(poses), "-o", str(tmp_path / "log.ply")]) == 3
    assert "12 columns are a pose of each scan without its time" in capsys.readouterr().err
    with pytest.raises(FormatError, match="begin each row with the time"):
        read_poses(poses)


def test_a_matrix_that_is_no_rotation_is_refused(tmp_path: pathlib.Path) -> None:
    poses = tmp_path / "poses.txt"
    poses.write_text("".join((line(t) if t else "2 0 0 0 0 1 0 0 0 0 1 0") + "\n" for t in [0.0, *MIDDLES[1:]]))
    with pytest.raises(FormatError, match="1 rows are no pose"):
        open_recording(capture(tmp_path), poses=poses)
    poses.write_text(f"40 {line(0)}\n41 {line(1)}\n")
    with pytest.raises(FormatError, match="no pose of a scan of the recording"):
        open_recording(capture(tmp_path), poses=poses)


def test_clouds_of_a_bag_have_a_pose_each(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
    from bag_messages import bag, some_points
    with bag(tmp_path / "bag") as out:
        for k in range(4):
            out.cloud("/points", 100 + 0.1 * k, some_points())
    (tmp_path / "poses.txt").write_text("".join(line(0.1 * k) + "\n" for k in range(4)))
    back = list(beams(open_recording(tmp_path / "bag", poses=tmp_path / "poses.txt")))
    np.testing.assert_allclose([piece["origin"][0] for piece in back], [[k, 2, 1.5] for k in range(4)], atol=1e-9)
