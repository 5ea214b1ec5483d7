"""Recordings as logs of the library, which must be installed."""
from __future__ import annotations

import importlib
import pathlib
from typing import Any

import numpy as np
import pytest
from format_data import Columns, end_points, generated_log, joined

pytest.importorskip("underbrush._core", reason="the library is not built: pip install .")
pytest.importorskip("rosbags", reason="rosbags is not installed: pip install 'underbrush[formats]'")
from underbrush.formats import export_log, open_recording  # noqa: E402
from underbrush.formats.log import beams_of_recording  # noqa: E402
from underbrush.formats.write_bag import BagWriter  # noqa: E402

underbrush: Any = importlib.import_module("underbrush")


def test_a_bag_becomes_a_log(tmp_path: pathlib.Path) -> None:
    log, poses = generated_log()
    with BagWriter(tmp_path / "log.mcap", poses, layout="velodyne") as writer:
        writer.write(log)
    recording = open_recording(tmp_path / "log.mcap")
    info, chunks = beams_of_recording(recording)
    assert info.sensor == "velodyne-vlp16" and info.has_misses and info.deskewed
    assert info.max_range_m == underbrush.Sensor("velodyne-vlp16").max_range_m
    assert [s.scan for s in info.scans] == [0, 1, 2]
    np.testing.assert_allclose([s.time_s for s in info.scans], [0, 0.1, 0.2], atol=1e-9)
    with underbrush.LogWriter(tmp_path / "log.ply", info) as out:
        for chunk in chunks:
            out.write(chunk)
    back = underbrush.read_log(tmp_path / "log.ply")
    same_log(back, log)
    assert export_log(tmp_path / "log.ply", tmp_path / "again.mcap", layout="velodyne") == {}
    info, chunks = beams_of_recording(open_recording(tmp_path / "again.mcap"))
    with underbrush.LogWriter(tmp_path / "again.ply", info) as out:
        for chunk in chunks:
            out.write(chunk)
    same_log(underbrush.read_log(tmp_path / "again.ply"), log)
    misses = int(np.isinf(log["range_m"]).sum())
    assert export_log(back, tmp_path / "log.laz", crs="EPSG:32633") == {"misses": misses}
    assert export_log(back, tmp_path / "log.npz") == {}
    assert export_log(back, tmp_path / "log.bag", layout="hesai", poses=poses) == {"misses": misses}
    assert open_recording(tmp_path / "log.laz").crs == "EPSG:32633"


def same_log(back: Any, log: Columns) -> None:
    found = joined([{name: np.asarray(getattr(back, name)) for name in
                     ("origin", "direction", "range_m", "time_s", "ring", "intensity")}])
    rows, same = (np.lexsort((one["ring"], np.round(one["time_s"], 7))) for one in (found, log))
    found, log = {k: c[rows] for k, c in found.items()}, {k: c[same] for k, c in log.items()}
    np.testing.assert_array_equal(np.isinf(found["range_m"]), np.isinf(log["range_m"]))
    np.testing.assert_allclose(end_points(found), end_points(log), atol=1e-4)
    np.testing.assert_array_equal(found["intensity"], log["intensity"])
