"""Every view keeps what it belongs to alive: all are read after their owner's name is gone and memory was reused.

`make asan-python` runs these under AddressSanitizer, which stops at the first read of memory that was freed. NumPy's
own loops are not instrumented, so `touch` reads the memory of a view with memcpy, which is."""
from __future__ import annotations

import ctypes
import gc
import os
import pathlib
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import underbrush
from underbrush import _core


def churn() -> None:
    """Frees what can be freed, and takes memory again."""
    gc.collect()
    waste = [underbrush.BeamLog(10_000) for _ in range(4)]
    for log in waste:
        log.range_m[:] = -1


def touch(view: np.ndarray) -> None:
    """Reads all memory between the first and the last byte of a view whose strides are not negative."""
    if view.size:
        span = sum((n - 1) * step for n, step in zip(view.shape, view.strides, strict=True)) + view.itemsize
        ctypes.string_at(view.__array_interface__["data"][0], span)


FREED = """
import ctypes
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes, libc.free.argtypes = ctypes.c_void_p, [ctypes.c_size_t], [ctypes.c_void_p]
at = libc.malloc(4096)
libc.free(at)
ctypes.string_at(at, 4096)
"""


@pytest.mark.skipif("libasan" not in os.environ.get("LD_PRELOAD", ""), reason="not under AddressSanitizer")
def test_the_sanitizer_is_alive() -> None:
    done = subprocess.run([sys.executable, "-c", FREED], check=False, capture_output=True, text=True)
    assert done.returncode != 0 and "heap-use-after-free" in done.stderr


MAKERS: dict[str, Callable[[underbrush.Model, pathlib.Path], Any]] = {
    "log": lambda model, path: underbrush.read_log(path),
    "slice": lambda model, path: underbrush.read_log(path).slice(100, 900),
    "chunk": lambda model, path: next(iter(underbrush.LogReader(path, chunk_size=500))),
    "simulated": lambda model, path: underbrush.simulate(model, like=path),
    "scan": lambda model, path: underbrush.Lidar(model, "velodyne-vlp16").scan(underbrush.Pose([0, 0, 1.8])),
    "ellipsoids": lambda model, path: underbrush.fit(path).ellipsoids,
    "ground": lambda model, path: underbrush.fit(path).ground,
    "sensor": lambda model, path: underbrush.Sensor("velodyne-vlp16"),
}


@pytest.mark.parametrize("name", list(MAKERS))
def test_views_of_an_owner_without_a_name(name: str, model: underbrush.Model, log_file: pathlib.Path) -> None:
    made = MAKERS[name](model, log_file)
    views = {key: getattr(made, key) for key in dir(made) if isinstance(getattr(made, key, None), np.ndarray)}
    if isinstance(made, underbrush.BeamLog):
        views |= made.extra
    before = {key: view.copy() for key, view in views.items()}
    assert views
    del made
    churn()
    for key, view in views.items():
        touch(view)
        assert np.array_equal(view, before[key], equal_nan=True), key


def test_views_of_views(log_file: pathlib.Path) -> None:
    log = underbrush.read_log(log_file)
    part, transposed, other = log.range_m[10:20], log.origin.T, np.from_dlpack(log.time_s)
    kept = part.copy(), transposed.copy(), other.copy()
    del log
    churn()
    touch(part)
    touch(transposed)
    touch(other)
    assert np.array_equal(part, kept[0]) and np.array_equal(transposed, kept[1]) and np.array_equal(other, kept[2])


def test_columns_added_later_do_not_move_earlier_views() -> None:
    log = underbrush.BeamLog(1000)
    first = log.add_column("first", np.uint16)
    first[:] = 7
    for k in range(50):
        log.add_column(f"column{k}", np.float32)
    churn()
    touch(first)
    assert (first == 7).all() and np.shares_memory(first, log.extra["first"])


def test_a_lidar_outlives_its_world_and_scans_their_lidar(log_file: pathlib.Path) -> None:
    model = underbrush.fit(log_file)
    lidar = underbrush.Lidar(model, "velodyne-vlp16")
    pose = underbrush.Pose([0, 0, 1.8])
    ranges = lidar.scan(pose).range_m.copy()
    del model
    churn()
    lidar.reset()
    scan = lidar.scan(pose)
    del lidar
    churn()
    touch(scan.range_m)
    assert np.array_equal(scan.range_m, ranges)


def test_tables_outlive_their_model_and_a_scene_its_models(model: underbrush.Model, log_file: pathlib.Path) -> None:
    labelled = underbrush.segment(log_file)
    plants = underbrush.extract(model, labelled.log)
    if len(plants):
        table = plants.copy_model(0).ellipsoids
        del plants
        churn()
        touch(table.mean)
        assert np.isfinite(table.mean).all()


def test_readers_in_the_middle(log_file: pathlib.Path) -> None:
    reader = underbrush.LogReader(log_file, chunk_size=300)
    chunks = iter(reader)
    first = next(chunks).range_m
    kept = first.copy()
    del reader, chunks
    churn()
    touch(first)
    assert np.array_equal(first, kept, equal_nan=True)


def test_threads_share_a_log(model: underbrush.Model, log: underbrush.BeamLog) -> None:
    def work() -> None:
        for _ in range(3):
            done = underbrush.simulate(model, like=log)
            assert len(done.range_m) == len(log)
            del done

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def test_errors_leave_nothing_half_made(log_file: pathlib.Path, tmp_path: pathlib.Path) -> None:
    broken = tmp_path / "broken.ply"
    data = log_file.read_bytes()
    for cut in (0, 10, 400, len(data) // 2, len(data) - 1):
        broken.write_bytes(data[:cut])
        with pytest.raises(underbrush.FormatError):
            underbrush.read_log(broken)
        with pytest.raises(underbrush.FormatError):
            list(underbrush.LogReader(broken, chunk_size=200))
    with pytest.raises((TypeError, ValueError)):
        _core.Trajectory(np.zeros(2), np.zeros((2, 3)), np.zeros((2, 4)))
