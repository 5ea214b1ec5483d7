"""`import --sensor` of recordings: a sensor that cannot have made the scans is refused, by rings, elevations or name."""
from __future__ import annotations

import pathlib

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")

import hesai_unit  # noqa: E402
from bag_messages import ODOMETRY, bag  # noqa: E402
from velodyne_unit import UNITS, observe, packets_of, save  # noqa: E402

import underbrush  # noqa: E402
from underbrush.formats import catalogue  # noqa: E402
from underbrush.import_recording import run  # noqa: E402


def cloud_of(path: pathlib.Path, sensor: str) -> pathlib.Path:
    """A bag of one revolution of a spinning sensor inside a sphere of 20 m."""
    elevation = np.radians(catalogue.load(sensor).elevation_deg)
    azimuth = np.linspace(0, 2 * np.pi, 360, endpoint=False)[:, None]
    xyz = 20 * np.stack(np.broadcast_arrays(np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                                            np.sin(elevation)), axis=-1).reshape(-1, 3)
    table = np.zeros(len(xyz), [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("ring", "<u2"), ("time", "<f4")])
    for k, name in enumerate("xyz"):
        table[name] = xyz[:, k]
    table["ring"] = np.tile(np.arange(len(elevation)), len(azimuth))
    table["time"] = np.repeat(np.linspace(0, 0.1, len(azimuth), endpoint=False), len(elevation))
    with bag(path, "ros1") as out:
        for k in range(4):
            out.pose("/odometry", ODOMETRY, 100 + 0.1 * (k - 1), "map", "velodyne", np.zeros(3), [0, 0, 0, 1])
        out.cloud("/points", 100.0, table, "velodyne")
    return path


@pytest.mark.parametrize(("sensor", "named", "reason"), [
    ("velodyne-hdl64e", "velodyne-vlp16", "ring 63 is in it, of 16 channels"),
    ("velodyne-vlp16", "velodyne-hdl64e", "lie beyond its elevations"),
    ("ouster-os0-128", "ouster-os1-128", "lie beyond its elevations"),
    ("velodyne-vlp16", "velodyne-vlp16", ""), ("velodyne-vlp16", "livox-avia", ""), ("ouster-os1-64", "ouster-os1-64", ""),
])
def test_clouds_of_bags(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str], sensor: str, named: str,
                        reason: str) -> None:
    log = tmp_path / "log.ply"
    code = run([str(cloud_of(tmp_path / "a.bag", sensor)), "--sensor", named, "-o", str(log)])
    said = capsys.readouterr().err
    assert code == (3 if reason else 0) and log.exists() == (not reason), said
    assert reason in said and (not reason or (said.count("\n") == 1 and f"'{named}' cannot be its sensor" in said))
    if not reason:
        assert underbrush.read_log(log).info.sensor == named


def test_packets_with_a_file_of_another_sensor(tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]) -> None:
    unit = hesai_unit.UNITS["xt32"]
    path = save(tmp_path / "a.pcap", hesai_unit.packets_of(unit, hesai_unit.observe(unit, 600)))
    for name, code in (("velodyne-vlp16", 3), ("hesai-xt32", 0)):
        log = tmp_path / f"{name}.ply"
        file = catalogue.folder() / f"{name}.yaml"
        assert run([str(path), "--position", "0,0,1.8", "--sensor", str(file), "-o", str(log)]) == code
        assert ("ring 31 is in it" in capsys.readouterr().err) == (code == 3) != log.exists()


def test_a_misspelt_sensor_is_named_with_the_most_similar(tmp_path: pathlib.Path,
                                                          capsys: pytest.CaptureFixture[str]) -> None:
    path = save(tmp_path / "a.pcap", packets_of(UNITS["vlp16"], observe(UNITS["vlp16"], 1200), 0x37))
    assert run([str(path), "--position", "0,0,1.8", "--sensor", "VLP16", "-o", str(tmp_path / "log.ply")]) == 2
    assert "did you mean 'velodyne-vlp16'?" in capsys.readouterr().err
