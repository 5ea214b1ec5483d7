"""The tasks of a plan (`underbrush plan`) on a Dask cluster (`pip install 'underbrush[dask]'`)."""
from __future__ import annotations

import json
import os
import pathlib
import subprocess
from typing import Any

from underbrush.cli import program
from underbrush.remote import Remote, run_task


def submit(plan: str | os.PathLike[str], client: Any, *, threads: int = 1, retries: int = 2,
           memory: bool = False, remote: Remote | None = None) -> list[Any]:
    """Submits the tasks of a plan to a Dask `Client`, and returns a future for each, in the order of their numbers.

    Workers need this package, and access under the same path to the folder in which this process works and the plan was
    made. A future's result has `seconds` and `peak_memory_bytes`; a task that fails `retries` + 1 times raises
    `RuntimeError` with the program's last lines, as do the tasks that take its outputs, and all others go on. With
    `memory`, each task requests the plan's guess of its memory as the resource `memory`, in bytes, which workers then
    must have (`dask worker --resources`).
    Once all futures are done, `underbrush merge PLAN` joins what they made.

    With `remote`, workers share no folder: files are fetched from where `underbrush.remote.put_plan` has put them, and
    `underbrush.remote.get_results` brings what the tasks made here before the merge.

    Raises `OSError` where there is no plan.
    """
    tasks = json.loads((pathlib.Path(plan) / "plan.json").read_text(encoding="utf-8"))["tasks"]
    futures: dict[int, Any] = {}
    for number, task in sorted(enumerate(tasks), key=lambda pair: pair[1]["stage"]):
        earlier = [futures[output["task"]] for output in task["earlier"]]
        futures[number] = client.submit(_run, os.fspath(plan), number, remote or os.getcwd(), threads, earlier,
                                        key=f"{pathlib.Path(plan).name}-{number}-{os.urandom(4).hex()}",
                                        retries=retries, resources={"memory": task["memory_bytes"]} if memory else None,
                                        pure=False)
    return [futures[number] for number in range(len(tasks))]


def _run(plan: str, number: int, folder: str | Remote, threads: int, _earlier: object) -> dict[str, Any]:
    """Runs a task on a worker; `_earlier` are the results of those whose outputs it takes."""
    if isinstance(folder, Remote):
        return run_task(pathlib.Path(plan).name, number, folder, threads=threads)
    done = subprocess.run([program(), "run", plan, "--task", str(number), "--threads", str(threads), "--json", "-"],
                          cwd=folder, check=False, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError((done.stderr.strip() or "?").splitlines()[-1])
    report: dict[str, Any] = json.loads(done.stdout)
    return report
