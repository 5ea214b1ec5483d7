"""Plans whose files lie elsewhere: in a folder that fsspec opens, and in an S3-compatible store on this machine."""
from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable, Iterator
from urllib.parse import urlunsplit

import pytest
from distributed import Client

import underbrush
from underbrush import dask
from underbrush.remote import Remote, get_results, put_plan, run_task

SECRET = "not-to-be-written"


@pytest.fixture(params=["file", "s3"])
def remote(request: pytest.FixtureRequest, tmp_path: pathlib.Path) -> Iterator[Remote]:
    """A folder elsewhere, in a file system or in a bucket."""
    pytest.importorskip("fsspec", reason="fsspec is not installed: pip install 'underbrush[remote]'")
    if request.param == "file":
        (tmp_path / "elsewhere").mkdir()
        yield Remote(f"file://{tmp_path}/elsewhere", str(tmp_path / "cache"))
        return
    s3fs = pytest.importorskip("s3fs", reason="s3fs is not installed")
    server = pytest.importorskip("moto.server", reason="moto[server] is not installed").ThreadedMotoServer(port=0, verbose=False)
    server.start()
    try:
        port = server.get_host_and_port()[1]
        storage = {"key": "someone", "secret": SECRET, "client_kwargs": {"endpoint_url": urlunsplit(("http", f"127.0.0.1:{port}", "", "", ""))}}
        bucket = f"bucket-{os.urandom(8).hex()}"
        s3fs.S3FileSystem(**storage).mkdir(bucket)
        yield Remote(f"s3://{bucket}/job", str(tmp_path / "cache"), storage=storage)
    finally:
        server.stop()


@pytest.fixture
def here(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, log: underbrush.BeamLog) -> pathlib.Path:
    """The working folder, with a log and a world."""
    folder = tmp_path / "here"
    (folder / "worlds").mkdir(parents=True)
    monkeypatch.chdir(folder)
    underbrush.write_log("log.ply", log)
    pathlib.Path("worlds/field.obj").write_text("v -50 -50 0\nv 50 -50 0\nv 0 50 0\nf 1 2 3\n")
    return folder


@pytest.mark.parametrize("command", ["simulate worlds/field.obj --like log.ply --range-noise 0.1 -o {}.ply",
                                     "fit log.ply --rounds 1 -o {}"])
def test_results_have_the_bytes_of_one_run(remote: Remote, here: pathlib.Path, run: Callable[..., str], command: str) -> None:
    pathlib.Path("job.yaml").write_text(f"command: {command.format('made')}\npieces: 3\n")
    run("plan", "job.yaml", "-o", "plan")
    put_plan("plan", remote)
    with pytest.raises(FileExistsError):
        put_plan("plan", remote)
    with Client(processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None) as client:
        ran = [future.result(60) for future in dask.submit("plan", client, remote=remote)]
    assert all(report["ran"] for report in ran)
    assert not run_task("plan", 0, remote)["ran"]
    assert list(pathlib.Path("plan/records").iterdir()) == []
    get_results("plan", remote)
    run("merge", "plan")
    run(*command.format("one").split())
    made = sorted(path for path in here.rglob("*") if path.is_file() and path.relative_to(here).parts[0].startswith("made"))
    assert made
    for path in made:
        assert path.read_bytes() == pathlib.Path(str(path).replace("/made", "/one")).read_bytes()
    written = [path.read_bytes() for path in pathlib.Path("plan").rglob("*.json")]
    assert not any(SECRET.encode() in text or b"s3://" in text for text in written)


def test_the_cache_is_bounded(remote: Remote, here: pathlib.Path, run: Callable[..., str]) -> None:
    for name in "abc":
        os.link("log.ply", f"{name}.ply")
    pathlib.Path("job.yaml").write_text("command: import {log}.ply -o {log}.ublog\nover: {log: [a, b, c]}\n")
    run("plan", "job.yaml", "-o", "plan")
    put_plan("plan", remote)
    size = pathlib.Path("log.ply").stat().st_size
    bounded = Remote(remote.url, remote.cache + "-small", 2 * size, remote.storage)
    for number in range(3):
        assert run_task("plan", number, bounded)["ran"]
        kept = [path for path in pathlib.Path(bounded.cache).rglob("*") if path.is_file() and path.suffix in (".ply", ".ublog")]
        assert sum(path.stat().st_size for path in kept) <= 2 * size
    with pytest.raises(OSError, match="more than the cache"):
        pathlib.Path("job.yaml").write_text("command: score a.ply b.ply --json score.json\n")
        run("plan", "job.yaml", "-o", "other")
        put_plan("other", remote)
        run_task("other", 0, Remote(remote.url, remote.cache + "-tiny", size, remote.storage))


def test_failures_are_named(remote: Remote, here: pathlib.Path, run: Callable[..., str]) -> None:
    pathlib.Path("job.yaml").write_text("command: import bad.ply -o good.ublog\n")
    pathlib.Path("bad.ply").write_bytes(pathlib.Path("log.ply").read_bytes()[:5000])
    run("plan", "job.yaml", "-o", "plan")
    put_plan("plan", remote)
    with pytest.raises(RuntimeError, match=r"task 0 failed.*bad\.ply"):
        run_task("plan", 0, remote)
    get_results("plan", remote)
    assert json.loads(pathlib.Path("plan/records/0.failed.json").read_text())["exit_code"] == 3
    pathlib.Path("job.yaml").write_text("command: import ../here/log.ply -o log.ublog\n")
    run("plan", "job.yaml", "-o", "outside")
    with pytest.raises(ValueError, match="below the folder"):
        put_plan("outside", remote)


def test_a_process_leaves_nothing_in_the_cache(tmp_path: pathlib.Path) -> None:
    cache = tmp_path / "cache"
    fork = "import os; from underbrush import remote\n" \
           f"folder = remote._cache_of(remote.Remote('file:///nowhere', {str(cache)!r})).work\n" \
           "if os.fork() == 0: raise SystemExit\n" \
           "os.wait()\n" \
           "assert folder.is_dir()"  # What a child does at its end is not the parent's.
    subprocess.run([sys.executable, "-c", fork], check=True)
    assert list(cache.iterdir()) == []
