"""The tasks of a plan on Dask clusters, in this process and of processes."""
from __future__ import annotations

import json
import os
import pathlib
import signal
from collections.abc import Callable, Iterator

import pytest
from distributed import Client, LocalCluster

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


@pytest.fixture
def cluster() -> Iterator[LocalCluster]:
    """Four worker processes, each of which is started again if it dies."""
    with LocalCluster(n_workers=4, threads_per_worker=1, processes=True, dashboard_address=":0") as made:
        yield made


def test_a_killed_worker_costs_its_task(cluster: LocalCluster, run: Callable[..., str], log: underbrush.BeamLog,
                                        tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    underbrush.write_log("log.ublog", log)
    command = "fit log.ublog --rounds 2 --seed 4 -o "
    pathlib.Path("job.yaml").write_text(f"command: {command}joined\npieces: 4\n")
    run("plan", "job.yaml", "-o", "plan")
    with Client(cluster) as client:
        workers = client.run(os.getpid)
        futures = dask.submit("plan", client)
        for future in (futures[0], futures[2]):  # one is killed at the start, and another one amid the sums of a round
            busy: list[int] = []
            while not busy and not future.done():
                busy = [workers[worker] for worker, keys in client.processing().items() if keys and worker in workers]
            assert busy
            os.kill(busy[0], signal.SIGKILL)
            future.result(60)
        assert [future.result(60)["task"] for future in futures] == list(range(len(futures)))
        assert len(set(workers.values()) - set(client.run(os.getpid).values())) >= 2
    run("merge", "plan")
    run(*command.split(), "one")
    joined, one = ({path.relative_to(name): path.read_bytes() for path in pathlib.Path(name).rglob("*") if path.is_file()}
                   for name in ("joined", "one"))
    assert joined == one


def test_three_failures_are_reported_and_other_commands_go_on(
        cluster: LocalCluster, run: Callable[..., str], log: underbrush.BeamLog, tmp_path: pathlib.Path,
        monkeypatch: pytest.MonkeyPatch) -> None:
    """A fit whose log is damaged fails, with all of its later tasks; the other fit has all of its stages."""
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        underbrush.write_log(f"{name}.ublog", log)
    with open("b.ublog", "r+b") as file:
        file.seek(5000)
        file.write(b"damage" * 20)
    pathlib.Path("job.yaml").write_text("command: fit {log}.ublog --rounds 1 -o {log}\nover: {log: [a, b]}\npieces: 2\n")
    run("plan", "job.yaml", "-o", "plan")
    tasks = json.loads(pathlib.Path("plan/plan.json").read_text())["tasks"]
    with Client(cluster) as client:
        for task, future in zip(tasks, dask.submit("plan", client), strict=True):
            if "b.ublog" in task["inputs"]:
                with pytest.raises(RuntimeError, match=r"task \d failed, with exit code 3: .*b\.ublog"):
                    future.result(60)
            else:
                assert future.result(60)["ran"]
    failed = json.loads(run("plan", "--status", "plan", "--json", "-"))["failed"]
    assert [failure["times"] for failure in failed.values()] == [3]
