"""Errors, threads, progress and Ctrl-C."""
from __future__ import annotations

import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import underbrush


def test_caller_errors(log: underbrush.BeamLog, model: underbrush.Model) -> None:
    with pytest.raises(ValueError, match="fitter is one of"):
        underbrush.fit(log, fitter="no")
    with pytest.raises(TypeError, match="did you mean 'tau'"):
        underbrush.fit(log, taau=3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="tau cannot be 'x'"):
        underbrush.fit(log, tau="x")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="did you mean 'velodyne-vlp16'"):
        underbrush.Sensor("velodyne-vlp-16")
    with pytest.raises(ValueError, match="draw"):
        underbrush.simulate(model, like=log, draw="sideways")
    with pytest.raises(TypeError, match="no option 'colour'"):
        underbrush.simulate(model, like=log, colour=1)  # type: ignore[call-overload]
    with pytest.raises(ValueError, match="trajectory"):
        underbrush.simulate(model)
    with pytest.raises(ValueError, match="length 1"):
        underbrush.Pose([0, 0, 0], [0, 0, 0, 2])
    with pytest.raises(ValueError, match="rigid"):
        underbrush.Lidar(model, "velodyne-vlp16").scan(np.ones((4, 4)))


def test_columns_that_were_spoiled(log: underbrush.BeamLog, model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    for name, value in (("origin", np.nan), ("origin", 1e300), ("direction", 0), ("range_m", np.nan), ("range_m", -1),
                        ("time_s", np.inf)):
        spoiled = log.copy()
        getattr(spoiled, name)[-1] = value
        for call in (lambda: underbrush.fit(spoiled), lambda: underbrush.simulate(model, like=spoiled),
                     lambda: underbrush.write_log(tmp_path / "spoiled.ply", spoiled)):
            with pytest.raises(ValueError, match=name.split("_")[0]):
                call()


def test_format_error(tmp_path: pathlib.Path, log_file: pathlib.Path) -> None:
    broken = tmp_path / "broken.ply"
    broken.write_bytes(log_file.read_bytes()[:-100])
    with pytest.raises(underbrush.FormatError) as raised:
        underbrush.read_log(broken)
    error = raised.value
    assert error.file == str(broken) and error.reason and str(error).startswith(str(broken) + ": ")
    assert isinstance(error, ValueError)
    with pytest.raises(underbrush.FormatError):
        underbrush.fit(broken)


def test_os_errors(log: underbrush.BeamLog, model: underbrush.Model, tmp_path: pathlib.Path) -> None:
    with pytest.raises(OSError):
        underbrush.write_log(tmp_path / "no" / "such" / "folder.ply", log)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    with pytest.raises(OSError, match="full"):
        underbrush.write_model(tmp_path / "full", model)
    assert (tmp_path / "full" / "mine.txt").exists()


def test_other_threads_run_meanwhile(log: underbrush.BeamLog) -> None:
    """While one thread fits, another counts: the GIL is free."""
    counted, stop = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    start = time.monotonic()
    underbrush.fit(log, fitter="likelihood", rounds=1)
    took = time.monotonic() - start
    stop.set()
    other.join()
    assert counted > 20 * took  # held, it would count at most once a switch interval or not at all


def test_two_calls_at_once(log: underbrush.BeamLog, model: underbrush.Model) -> None:
    out: list[underbrush.BeamLog] = []
    workers = [threading.Thread(target=lambda: out.append(underbrush.simulate(model, like=log))) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(out) == 4 and all(np.array_equal(out[0].range_m, o.range_m) for o in out)


def test_progress(log: underbrush.BeamLog) -> None:
    seen: list[tuple[str, int, int]] = []
    underbrush.fit(log, fitter="likelihood", rounds=1, progress=lambda *state: seen.append(state))
    assert seen and all(done <= total for _, done, total in seen)

    def fail(stage: str, done: int, total: int) -> None:
        raise KeyError(stage)

    with pytest.raises(KeyError):
        underbrush.fit(log, fitter="likelihood", rounds=5, progress=fail)


PROGRAM = """
import signal, sys, underbrush
signal.signal(signal.SIGINT, signal.default_int_handler)  # Jobs of a shell's background ignore it.
print("ready", flush=True)
try:
    while True:
        underbrush.fit(sys.argv[1], fitter="likelihood", rounds=50)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c(log_file: pathlib.Path) -> None:
    with subprocess.Popen([sys.executable, "-c", PROGRAM, str(log_file)], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == "ready\n"
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            start = time.monotonic()
            assert process.communicate(timeout=60)[0] == "interrupted\n"
            assert time.monotonic() - start < 20 and process.returncode == 0
        finally:
            process.kill()


def test_threads() -> None:
    underbrush.set_threads(1)
    assert underbrush.threads() == 1
    underbrush.set_threads(0)


def test_catalogue() -> None:
    assert "velodyne-vlp16" in underbrush.sensors()
    sensor = underbrush.Sensor("velodyne-vlp16")
    assert sensor.channels == 16 and len(sensor.elevation_rad) == 16 and sensor.kind == "spinning"
    assert underbrush.Sensor("ibeo-lux-2010").kind == "sweep"
    assert underbrush.class_names()[1] == "ground"
