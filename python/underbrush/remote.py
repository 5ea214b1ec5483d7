"""Plans whose files are where fsspec opens them (`pip install 'underbrush[remote]'`): object stores, HTTP, SSH and others.

A folder elsewhere takes the place of the one in which a plan was made: `put_plan` puts the plan and its inputs there,
`run_task` runs a task on any machine that reaches it, `underbrush.dask.submit(..., remote=...)` all tasks on a cluster,
and `get_results` brings what they made to where `underbrush merge` joins it. Neither plans nor records contain
credentials: these are options of fsspec, or are found by fsspec itself (environment, profiles).
"""
from __future__ import annotations

import atexit
import contextlib
import dataclasses
import fcntl
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from typing import Any, IO

from underbrush.cli import program
from underbrush.files import PathLike, need


@dataclasses.dataclass(frozen=True)
class Remote:
    """A folder elsewhere, and the cache of the machines that work on its files."""

    url: str  #: The folder, such as s3://bucket/job.
    cache: str  #: A folder on the disk of each machine; each process has its own part of it.
    cache_bytes: int = 16 << 30  #: The most bytes of files that a process keeps there.
    storage: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)  #: Options of fsspec.

    def open(self) -> tuple[Any, str]:
        """Returns the file system and the folder's path in it. Raises `ImportError` without fsspec."""
        files, root = need("fsspec.core", "remote").url_to_fs(self.url, use_listings_cache=False, **self.storage)
        return files, str(root).rstrip("/")


def put_plan(plan: PathLike, remote: Remote) -> None:
    """Puts a plan and its inputs, which lie below the working folder, into the folder elsewhere.

    Raises `FileExistsError` where a plan of this name is there, and `ValueError` for an input that lies elsewhere.
    """
    files, root = remote.open()
    name = pathlib.Path(plan).name
    if files.exists(f"{root}/{name}/plan.json"):
        raise FileExistsError(17, "a plan is there already", f"{remote.url}/{name}")
    manifest = pathlib.Path(plan) / "plan.json"
    for path in json.loads(manifest.read_text(encoding="utf-8"))["inputs"]:
        _put(files, pathlib.Path(_below(path)), f"{root}/{path}")
    _put(files, manifest, f"{root}/{name}/plan.json")


def run_task(plan: str, number: int, remote: Remote, *, threads: int = 1) -> dict[str, Any]:
    """Runs a task of the plan of this name, unless its record is there, and returns its report.

    What the task reads is fetched to the cache, and what it made is put back, its record last. Raises `RuntimeError`
    with the program's last line where the task fails, and `OSError` where its files are more than the cache holds.
    """
    files, root = remote.open()
    place = f"{root}/{plan}"
    record = f"{place}/records/{number}.json"
    if files.exists(record):
        known: dict[str, Any] = json.loads(files.cat_file(record))
        return {"task": number, "ran": False, "seconds": known["seconds"], "peak_memory_bytes": known["peak_memory_bytes"]}
    manifest = files.cat_file(f"{place}/plan.json")
    task = json.loads(manifest)["tasks"][number]
    earlier = {k: files.cat_file(f"{place}/records/{k}.json") for k in {e["task"] for e in task["earlier"]}}
    needed = [_below(path) for path in task["inputs"]]
    needed += [f"{plan}/{output['path']}" for text in earlier.values() for output in json.loads(text)["outputs"]]
    with _cache_of(remote).holding(files, root, needed) as work:
        _write(work / plan / "plan.json", manifest)
        for k, text in earlier.items():
            _write(work / plan / "records" / f"{k}.json", text)
        for part in ("outputs", "records"):
            (work / plan / part).mkdir(exist_ok=True)
        done = subprocess.run([program(), "run", plan, "--task", str(number), "--threads", str(threads), "--json", "-"],
                              cwd=work, check=False, capture_output=True, text=True)
        made = work / plan / "records" / f"{number}.json"
        if done.returncode:
            failed = made.with_suffix(".failed.json")
            if failed.exists():
                _put(files, failed, f"{place}/records/{failed.name}")
            raise RuntimeError((done.stderr.strip() or "?").splitlines()[-1])
        text = made.read_bytes()
        for folder in {str(pathlib.PurePath(output["path"]).parent) for output in json.loads(text)["outputs"]}:
            _put(files, work / plan / folder, f"{place}/{folder}")
            shutil.rmtree(work / plan / folder, ignore_errors=True)
        _put(files, made, record)
        made.unlink()
        report: dict[str, Any] = json.loads(done.stdout)
        return report


def get_results(plan: PathLike, remote: Remote) -> None:
    """Brings the records and outputs of a plan's tasks into its folder here, for `underbrush merge`.

    Raises `ValueError` where the plan elsewhere is another one.
    """
    files, root = remote.open()
    folder = pathlib.Path(plan)
    place = f"{root}/{folder.name}"
    if files.cat_file(f"{place}/plan.json") != (folder / "plan.json").read_bytes():
        raise ValueError(f"{remote.url}/{folder.name}: not the plan in {folder}")
    for part in ("outputs", "records"):  # If a record is here, its outputs are here, too.
        if files.exists(f"{place}/{part}"):
            _get(files, f"{place}/{part}", folder / part)


class _Cache:
    """A process's part of the cache. Threads share it; parts of processes that are no more are removed."""

    def __init__(self, folder: pathlib.Path, most_bytes: int) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("process-*"):
            with contextlib.suppress(OSError), open(old / "lock", "wb") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(old, ignore_errors=True)
        self.work = pathlib.Path(tempfile.mkdtemp(prefix="process-", dir=folder))
        self._lock: IO[bytes] = open(self.work / "lock", "wb")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        self._most_bytes = most_bytes
        self._guard = threading.Lock()
        self._bytes: dict[str, int] = {}  # Of each file or folder that is there, the one used last at the end.
        self._users: dict[str, int] = {}

    @contextlib.contextmanager
    def holding(self, files: Any, root: str, paths: list[str]) -> Iterator[pathlib.Path]:
        """Fetches what is not there yet, keeps it while the block runs, and yields the folder."""
        held: list[str] = []
        try:
            with self._guard:
                for path in paths:
                    self._users[path] = self._users.get(path, 0) + 1
                    held.append(path)
                for path in paths:
                    self._fetch(files, root, path)
            yield self.work
        finally:
            with self._guard:
                for path in held:
                    self._users[path] -= 1

    def close(self) -> None:
        """Removes this part of the cache, which no other process reads."""
        shutil.rmtree(self.work, ignore_errors=True)
        self._lock.close()

    def _fetch(self, files: Any, root: str, path: str) -> None:
        if path in self._bytes:
            self._bytes[path] = self._bytes.pop(path)
            return
        size = sum(files.sizes(_files_below(files, f"{root}/{path}")))
        for old in [p for p in self._bytes if not self._users.get(p)]:
            if sum(self._bytes.values()) + size <= self._most_bytes:
                break
            shutil.rmtree(self.work / old) if (self.work / old).is_dir() else (self.work / old).unlink()
            del self._bytes[old]
        if sum(self._bytes.values()) + size > self._most_bytes:
            raise OSError(28, "the files of the tasks are more than the cache may hold", path)
        _get(files, f"{root}/{path}", self.work / path)
        self._bytes[path] = size


_caches: dict[str, _Cache] = {}
_caches_guard = threading.Lock()


def _cache_of(remote: Remote) -> _Cache:
    """The part of this process in the cache of a folder elsewhere."""
    with _caches_guard:
        key = f"{os.getpid()} {remote.cache} {remote.url}"
        if key not in _caches:
            _caches[key] = _Cache(pathlib.Path(remote.cache).absolute(), remote.cache_bytes)
        return _caches[key]


@atexit.register
def _close_caches() -> None:
    """Closes the caches of this process; those of a process that forked this one stay."""
    with _caches_guard:
        for key in [k for k in _caches if k.startswith(f"{os.getpid()} ")]:
            _caches.pop(key).close()


def _below(path: str) -> str:
    """The path itself. Raises `ValueError` unless it leads to below the working folder."""
    if os.path.isabs(path) or os.path.normpath(path).split(os.sep)[0] == os.pardir:
        raise ValueError(f"{path}: an input of a plan elsewhere lies below the folder of the plan")
    return path


def _files_below(files: Any, place: str) -> list[str]:
    """A file itself, or all files of a folder. Raises `FileNotFoundError` where there are none."""
    found: list[str] = files.find(place)
    if not found:
        raise FileNotFoundError(2, "nothing is there", place)
    return found


def _get(files: Any, place: str, target: pathlib.Path) -> None:
    """Fetches a file or folder; each file appears whole."""
    for file in _files_below(files, place):
        rest = file.removeprefix(place.lstrip("/") if not file.startswith("/") else place).lstrip("/")
        to = target / rest if rest else target
        to.parent.mkdir(parents=True, exist_ok=True)
        part = to.with_name(f".{to.name}.part")
        files.get_file(file, str(part))
        os.replace(part, to)


def _put(files: Any, path: pathlib.Path, place: str) -> None:
    """Puts a file or folder."""
    for file in sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]:
        to = f"{place}/{file.relative_to(path).as_posix()}" if path.is_dir() else place
        files.makedirs(to.rpartition("/")[0], exist_ok=True)
        files.put_file(str(file), to)


def _write(path: pathlib.Path, content: bytes) -> None:
    """Writes a file that appears whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(content)
    os.replace(file.name, path)
