"""Misses inferred for point clouds of bags: the beams that a sensor of known pattern fired and that had no return."""
from __future__ import annotations

import json
import pathlib
from collections.abc import Callable

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")

import underbrush  # noqa: E402
from bag_messages import bag  # noqa: E402
from packet_files import VLP16, room_range  # noqa: E402
from underbrush.formats.layouts import LAYOUTS  # noqa: E402
from underbrush.import_recording import run  # noqa: E402

ELEVATION = np.radians(sorted(VLP16))
STEP = 2 * np.pi * 55.296e-6 / 0.1  #: Between firings at ten revolutions a second.
FIRINGS = round(2 * np.pi / STEP)


def beams() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directions (firings, rings, 3), whether each beam returns, and its time, s, in a revolution from the rear.

    Ring 15 sees only sky. Of the others, between 30 and 60 degrees nothing returns.
    """
    turned = np.arange(FIRINGS) * STEP
    azimuth = np.pi - turned[:, None] + 0 * ELEVATION
    flat = np.cos(ELEVATION)
    direction = np.stack([np.cos(azimuth) * flat, np.sin(azimuth) * flat, np.sin(ELEVATION) + 0 * azimuth], -1)
    returns = ~((azimuth > np.radians(30)) & (azimuth < np.radians(60)))
    returns[:, 15] = False
    return direction, returns, np.repeat(turned[:, None] / (2 * np.pi) * 0.1, 16, axis=1)


DIRECTION, RETURNS, TIME = beams()


def write_bag(path: pathlib.Path, timed: bool, ringed: bool, organised: bool = False,
              number: Callable[[np.ndarray], np.ndarray] = lambda ring: ring) -> None:
    dtype = LAYOUTS["velodyne"].dtype if timed else np.dtype([(n, "<f4") for n in ("x", "y", "z", "intensity")] + (
        [("ring", "<u2")] if ringed else []))
    points = np.zeros(RETURNS.shape, dtype)
    point = DIRECTION * room_range(DIRECTION)[..., None]
    for axis, name in enumerate("xyz"):
        points[name] = np.where(RETURNS, point[..., axis], np.nan)
    points["intensity"] = 7
    if "ring" in (dtype.names or ()):
        points["ring"] = number(np.arange(16))
    if timed:
        points["time"] = TIME
    if not organised:
        points = points[RETURNS] if ringed else points.T[RETURNS.T]  # Without rings, one ring after the other.
    with bag(path) as out:
        for k in range(3):
            out.cloud("/points", 100 + 0.1 * k, points)
            out.transform("/tf", 100 + 0.1 * k, "map", "lidar", [k, 0, 0], [0, 0, 0, 1])
        out.transform("/tf", 100.4, "map", "lidar", [4, 0, 0], [0, 0, 0, 1])


@pytest.mark.parametrize(("timed", "ringed"), [(True, True), (False, True), (False, False)])
def test_the_beams_without_returns_are_found(tmp_path: pathlib.Path, timed: bool, ringed: bool) -> None:
    write_bag(tmp_path / "bag", timed, ringed)
    words = [str(tmp_path / "bag"), "--infer-misses", "velodyne-vlp16", "-o", str(tmp_path / "log.ply"), "--json",
             str(tmp_path / "counts.json")]
    assert run(words) == 0
    counts = json.loads((tmp_path / "counts.json").read_text())
    log = underbrush.read_log(tmp_path / "log.ply")
    assert log.info.has_misses and log.info.sensor == "velodyne-vlp16" and log.info.max_range_m == 100
    miss = np.isinf(log.range_m)
    assert counts["hits"] == 3 * RETURNS.sum() == (~miss).sum() and counts["misses"] == counts["misses_inferred"]
    np.testing.assert_array_equal((log.flags & 1) > 0, miss)
    assert (log.intensity[miss] == 0).all() and (log.intensity[~miss] == 7).all()
    # The lowest ring points below -13 degrees: its beams without a return are unknown.
    gap = int((~RETURNS[:, 1]).sum())
    assert abs(counts["unknown"] - 3 * gap) <= 3
    for scan in range(3):
        rows = miss & (log.scan == scan)
        number = np.bincount(log.ring[rows], minlength=16)
        assert number[0] == 0 and number[15] == FIRINGS and (np.abs(number[1:15] - gap) <= 1).all()
        for ring in (1, 7, 14):
            found, fired = log.direction[rows & (log.ring == ring)], DIRECTION[~RETURNS[:, ring], ring]
            nearest = np.arccos(np.clip((found @ fired.T).max(axis=1), -1, 1))
            assert np.degrees(nearest).max() < 0.1
            if timed:
                nth = (found @ fired.T).argmax(axis=1)
                times = 100 + 0.1 * scan + TIME[~RETURNS[:, ring], ring][nth]
                np.testing.assert_allclose(log.time_s[rows & (log.ring == ring)], times, atol=1e-4)
        origin = log.origin[log.scan == scan]
        np.testing.assert_allclose(origin[:, 0], 10 * (log.time_s[log.scan == scan] - 100), atol=1e-4)


def test_misses_outside_the_times_of_the_poses_do_not_count(tmp_path: pathlib.Path) -> None:
    write_bag(tmp_path / "bag", True, True)
    (tmp_path / "poses.txt").write_text("100 0 0 0 0 0 0 1\n100.25 2.5 0 0 0 0 0 1\n")
    words = [str(tmp_path / "bag"), "--infer-misses", "velodyne-vlp16", "--poses", str(tmp_path / "poses.txt"), "-o",
             str(tmp_path / "log.ply"), "--json", str(tmp_path / "counts.json")]
    assert run(words) == 0
    counts, log = json.loads((tmp_path / "counts.json").read_text()), underbrush.read_log(tmp_path / "log.ply")
    assert "beams outside the times of the poses" in counts["skipped"]
    assert counts["misses_inferred"] == counts["misses"] == np.isinf(log.range_m).sum()


@pytest.mark.parametrize("number", [lambda ring: 0 * ring, lambda ring: ring + 1, lambda ring: 15 - ring])
def test_rings_with_other_numbers_have_the_same_misses(tmp_path: pathlib.Path,
                                                       number: Callable[[np.ndarray], np.ndarray]) -> None:
    for name, numbers in (("own", lambda ring: ring), ("other", number)):
        write_bag(tmp_path / name, True, True, number=numbers)
        assert run([str(tmp_path / name), "--infer-misses", "velodyne-vlp16", "-o", str(tmp_path / f"{name}.ply")]) == 0
    own, other = (underbrush.read_log(tmp_path / f"{name}.ply") for name in ("own", "other"))
    np.testing.assert_array_equal(own.ring, other.ring)
    np.testing.assert_array_equal(own.range_m, other.range_m)
    np.testing.assert_allclose(own.direction, other.direction, atol=1e-6)


def test_rings_below_an_angle_are_unknown(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_bag(tmp_path / "bag", True, True)
    words = [str(tmp_path / "bag"), "--infer-misses", "velodyne-vlp16", "-o", str(tmp_path / "log.ply")]
    assert run([*words, "--unknown-below-deg", "-90"]) == 0
    assert "beams without a known end" not in capsys.readouterr().out
    log = underbrush.read_log(tmp_path / "log.ply")
    assert abs(int((np.isinf(log.range_m) & (log.ring == 0)).sum()) - 3 * int((~RETURNS[:, 0]).sum())) <= 3
    assert run([str(tmp_path / "bag"), "--unknown-below-deg", "-5", "-o", str(tmp_path / "log.ply")]) == 2
    assert "needs --infer-misses" in capsys.readouterr().err


def test_a_log_without_misses_names_the_option(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_bag(tmp_path / "bag", True, True)
    assert run([str(tmp_path / "bag"), "-o", str(tmp_path / "log.ply")]) == 0
    said = capsys.readouterr().out
    assert " 0 misses" in said and "cannot be learnt from it (see --infer-misses SENSOR)" in said


def test_clouds_with_misses_of_their_own_keep_them(tmp_path: pathlib.Path) -> None:
    write_bag(tmp_path / "bag", True, True, organised=True)
    words = [str(tmp_path / "bag"), "--infer-misses", "velodyne-vlp16", "-o", str(tmp_path / "log.ply")]
    assert run(words) == 0
    log = underbrush.read_log(tmp_path / "log.ply")
    assert len(log) == 3 * RETURNS.size and not (log.flags & 1).any()


@pytest.mark.parametrize(("sensor", "code", "reason"), [
    ("velodyne-hdl64e", 3, "bag: --infer-misses: 'velodyne-hdl64e' cannot be its sensor: "),
    ("livox-mid360", 2, "'livox-mid360': --infer-misses needs a spinning sensor"), ("vlp17", 2, "vlp17")])
def test_a_sensor_that_it_cannot_be_is_refused(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], sensor: str,
                                              code: int, reason: str) -> None:
    write_bag(tmp_path / "bag", True, True)
    assert run([str(tmp_path / "bag"), "--infer-misses", sensor, "-o", str(tmp_path / "log.ply")]) == code
    assert reason in capsys.readouterr().err and not (tmp_path / "log.ply").exists()


def test_recordings_without_a_scan_pattern_are_refused(tmp_path: pathlib.Path,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    las = pathlib.Path(__file__).resolve().parents[2] / "tests/cases/common_options/scan.las"
    words = ["--position", "532100,5412300,311.8", "--infer-misses", "velodyne-vlp16", "-o", str(tmp_path / "log.ply")]
    assert run([str(las), *words]) == 2
    assert "--infer-misses is for point clouds of bags" in capsys.readouterr().err
