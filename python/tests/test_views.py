"""Columns are views: nothing is copied, and a view keeps its owner alive."""
from __future__ import annotations

import gc
import pathlib

import numpy as np
import pytest

import underbrush

COLUMNS = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags")


def resident() -> int:
    """Resident memory of this process, bytes."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_are_views(name: str) -> None:
    log = underbrush.BeamLog(1000)
    one, other = getattr(log, name), getattr(log, name)
    assert np.shares_memory(one, other) and one.flags.writeable and len(one) == 1000
    one[5] = 1
    assert (other[5] == 1).all()


def test_extra_columns_are_views() -> None:
    log = underbrush.BeamLog(10)
    added = log.add_column("class", np.uint8)
    added[3] = 7
    assert log.extra["class"][3] == 7 and np.shares_memory(added, log.extra["class"])
    with pytest.raises(ValueError, match="name"):
        log.add_column("class", np.uint8)
    with pytest.raises(ValueError, match="name"):
        log.add_column("range_m", np.uint8)
    with pytest.raises(ValueError, match="int64"):
        log.add_column("other", np.int64)


def test_views_outlive_their_owner(model: underbrush.Model, log_file: pathlib.Path) -> None:
    log = underbrush.read_log(log_file)
    views = {name: getattr(log, name) for name in COLUMNS}
    kept = {name: view.copy() for name, view in views.items()}
    del log
    gc.collect()
    waste = [underbrush.BeamLog(100_000) for _ in range(4)]  # takes over memory that was freed
    for name, view in views.items():
        assert np.array_equal(view, kept[name], equal_nan=True), name
    del waste
    again = underbrush.fit(log_file)
    mean, vertices, p = again.ellipsoids.mean, again.ground.vertices, again.ellipsoids.hit_probability
    del again
    gc.collect()
    assert np.array_equal(mean, model.ellipsoids.mean)
    assert np.array_equal(vertices, model.ground.vertices)
    assert np.array_equal(p, model.ellipsoids.hit_probability)


def test_tables_of_a_model(model: underbrush.Model) -> None:
    e = model.ellipsoids
    assert len(e) > 10 and e.mean.shape == (len(e), 3) and e.covariance.shape == (len(e), 6)
    assert ((0 <= e.hit_probability) & (e.hit_probability <= 1)).all() and e.hits.sum() > 0 and e.misses.sum() > 0
    assert np.shares_memory(e.mean, model.ellipsoids.hits) is False  # interleaved, not overlapping
    assert not e.mean.flags.writeable and e.mean.base is not None
    sigma, axes = underbrush.ellipsoid_axes(e)
    assert np.allclose((axes * sigma[:, None] ** 2 @ axes.transpose(0, 2, 1))[:, 0, 0], e.covariance[:, 0], rtol=1e-3)
    assert model.ground.triangles.max() < len(model.ground.vertices)


def test_dlpack() -> None:
    log = underbrush.BeamLog(10)
    seen = np.from_dlpack(log.range_m)
    assert np.shares_memory(seen, log.range_m)


def test_memory_of_views() -> None:
    n = 2_000_000
    log = underbrush.BeamLog(n)
    log.range_m[:] = 1
    before = resident()
    views = [getattr(log, name) for name in COLUMNS for _ in range(50)]
    assert resident() - before < 4 << 20 and len(views) == 50 * len(COLUMNS)


def test_log_from_columns() -> None:
    origin, direction = np.zeros((4, 3)), np.tile([1.0, 0, 0], (4, 1))
    log = underbrush.log_from_columns(origin=origin, direction=direction, range_m=[1, 2, np.inf, 3],
                                      extra={"class": np.array([1, 2, 0, 1], np.uint8)})
    assert log.info.has_misses and list(log.extra["class"]) == [1, 2, 0, 1] and log.range_m[1] == 2
    assert np.allclose(log.end_points()[:2, 0], [1, 2])
    with pytest.raises(ValueError, match="origin"):
        underbrush.log_from_columns(origin=origin[:2], direction=direction, range_m=[1, 2, 3, 4])


def test_slices_and_copies(log: underbrush.BeamLog) -> None:
    part = log.slice(10, 20)
    assert len(part) == 10 and np.array_equal(part.range_m, log.range_m[10:20])
    assert not np.shares_memory(log.copy().range_m, log.range_m)
    with pytest.raises(ValueError):
        log.slice(10, len(log) + 1)


def test_reader_and_writer(log: underbrush.BeamLog, log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    reader = underbrush.LogReader(log_file, chunk_size=1000)
    chunks = list(reader)
    assert len(chunks) > 10 and sum(map(len, chunks)) == len(log) == len(reader)
    with underbrush.LogWriter(tmp_path / "a.ply", reader.info) as writer:
        for chunk in reader:  # iterating starts again
            writer.write(chunk)
        assert not (tmp_path / "a.ply").exists()
    again = underbrush.read_log(tmp_path / "a.ply")
    assert np.array_equal(again.range_m, underbrush.read_log(log_file).range_m)
    with pytest.raises(RuntimeError), underbrush.LogWriter(tmp_path / "b.ply", reader.info) as writer:
        writer.write(chunks[0])
        raise RuntimeError
    assert not (tmp_path / "b.ply").exists()


def test_scans_of_a_live_sensor_are_their_own(model: underbrush.Model) -> None:
    lidar = underbrush.Lidar(model, "velodyne-vlp16")
    pose = underbrush.Pose([0, 0, 1.8])
    first = lidar.scan(pose)
    kept = first.range_m.copy()
    second = lidar.scan(pose, time=0.1)
    assert np.array_equal(first.range_m, kept) and not np.shares_memory(first.range_m, second.range_m)
    assert first.scan[0] == 0 and second.scan[0] == 1 and not np.array_equal(first.range_m, second.range_m)
    lidar.reset()
    assert np.array_equal(lidar.scan(pose).range_m, kept)


def test_compact_logs_hold_every_bit(log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    log = underbrush.read_log(log_file)
    underbrush.write_log(tmp_path / "log.ublog", log)
    again = underbrush.read_log(tmp_path / "log.ublog")
    for column in ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags"):
        assert getattr(again, column).tobytes() == getattr(log, column).tobytes(), column
    assert (tmp_path / "log.ublog").stat().st_size < log_file.stat().st_size / 2
    assert len(next(iter(underbrush.LogReader(tmp_path / "log.ublog", chunk_size=100)))) == 100
