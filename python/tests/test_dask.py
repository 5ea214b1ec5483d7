"""The tasks of a plan on a Dask cluster in this process."""
from __future__ import annotations

import os
import pathlib
from collections.abc import Callable, Iterator

import pytest
from distributed import Client

import underbrush
from underbrush import dask


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    """A cluster of two workers' threads, which talk within this process."""
    with Client(processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None,
                resources={"memory": 1 << 40}) as made:
        yield made


def test_tasks_become_futures(client: Client, run: Callable[..., str], log: underbrush.BeamLog, tmp_path: pathlib.Path,
                              monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    underbrush.write_log("log.ply", log)
    pathlib.Path("field.obj").write_text("v -50 -50 0\nv 50 -50 0\nv 0 50 0\nf 1 2 3\n")
    command = "simulate field.obj --like log.ply --range-noise 0.1 -o "
    pathlib.Path("job.yaml").write_text(f"command: {command}sim.ply\npieces: 4\n")
    run("plan", "job.yaml", "-o", "plan")
    futures = dask.submit("plan", client, memory=True)
    assert [future.result(60)["task"] for future in futures] == [0, 1, 2, 3]
    run("merge", "plan")
    run(*command.split(), "one.ply")
    assert pathlib.Path("sim.ply").read_bytes() == pathlib.Path("one.ply").read_bytes()


def test_a_failure_is_named_and_the_others_go_on(client: Client, run: Callable[..., str], log: underbrush.BeamLog,
                                                 tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        underbrush.write_log(f"{name}.ply", log)
    os.truncate("b.ply", 5000)
    pathlib.Path("job.yaml").write_text("command: import {log}.ply -o {log}.ublog\nover: {log: [a, b]}\n")
    run("plan", "job.yaml", "-o", "plan")
    good, bad = dask.submit("plan", client, retries=1)
    assert good.result(60)["ran"]
    with pytest.raises(RuntimeError, match=r"task 1 failed.*b\.ply"):
        bad.result(60)
    assert '"times": 2' in pathlib.Path("plan/records/1.failed.json").read_text()
