"""Logs that verbs of the command write in a format of the package's writers: bags, LAS and LAZ, NumPy."""
from __future__ import annotations

import pathlib
import subprocess
import sys
import tempfile
from collections.abc import Sequence

#: Verbs whose `-o` is one log, and the ends of the names that the package writes.
VERBS = ("import", "simulate", "movers", "segment")
ENDS = (".mcap", ".db3", ".bag", ".las", ".laz", ".npz")


def value_of(words: Sequence[str], *names: str) -> str:
    """The value of an option of these names among the words; empty where it is not there."""
    for before, word in zip(["", *words], words):
        name, equals, value = word.partition("=")
        if before in names:
            return word
        if equals and name in names:
            return value
    return ""


def without(words: Sequence[str], *names: str) -> list[str]:
    """The words without an option of these names and its value."""
    return [w for before, w in zip(["", *words], words) if before not in names and w.partition("=")[0] not in names]


def output_of(words: Sequence[str]) -> str:
    """The log that the words have the package write; empty where the program writes their output."""
    name = value_of(words, "-o", "--output") if len(words) and words[0] in VERBS else ""
    return name if name.lower().endswith(ENDS) else ""


def layout_of(profile: str, sensor: str) -> str:
    """The driver's layout of point clouds: the one that is named, else that of the sensor's maker."""
    return profile or ("velodyne" if sensor.startswith("velodyne") else "ouster")


def run(words: Sequence[str]) -> int:
    """Runs the words with a log of the program as their output, writes that in the format of the name, and returns the
    exit code. Raises `ValueError`, `ImportError`, `OSError`."""
    from underbrush import LogReader
    from underbrush._core import check_outputs
    from underbrush.formats.log import export_log
    output = pathlib.Path(output_of(words))
    check_outputs([("--output", str(output))], [], "--force" in words)
    profile, trajectory = value_of(words, "--profile"), value_of(words, "--trajectory")
    with tempfile.TemporaryDirectory(prefix=".underbrush-", dir=output.parent) as folder:
        log = pathlib.Path(folder) / (output.stem + ".ply")
        done = subprocess.run([sys.executable, "-m", "underbrush.cli", *without(words, "-o", "--output", "--profile"),
                               "-o", str(log)], check=False, stdout=subprocess.PIPE, text=True)
        if done.returncode:
            return done.returncode
        lost = export_log(log, output, layout=layout_of(profile, LogReader(log).info.sensor),
                          poses=trajectory if trajectory and not trajectory.endswith((".ply", ".ublog")) else None)
        print(done.stdout.replace(str(log), str(output)), end="")
    if value_of(words, "--json") != "-":
        for why, count in lost.items():
            print(f"  not kept    {count} {why}")
    return 0
