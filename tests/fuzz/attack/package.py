"""Attacks on the Python package, each in a process of its own, which no call may end."""
import json
import os
import pathlib
import re
import shutil
import subprocess

import bounded
from bounded import ANSWER, REFUSAL

TESTS = pathlib.Path(__file__).resolve().parents[3] / "python/tests"
#: Programs that give the readers of recordings lies in the fields of each format, and how many of each.
LIARS = (("recordings", "mutate_formats.py", ("--lies", "--count", "200")),
         ("captures", "mutate_packets.py", ("--lies", "--mutants", "60")))
COUNTED = re.compile(r"(\d+) (read|counted|scans(?:, with counts of what was left out)?|asked|refused)\b")
ATTACKS = ("strides", "kinds", "spoiled", "lifetimes", "forks", "interrupted", "shared")


def lies(python, paths, table):
    """Lies in recordings and captures; each program prints what came of each kind of file."""
    for name, script, words in LIARS:
        done = subprocess.run([python, TESTS / script, *words], env=paths, text=True, capture_output=True, check=False)
        for count, what in COUNTED.findall(done.stdout):
            table.add("Python: lies in " + name, REFUSAL if what in ("asked", "refused") else ANSWER, count=int(count))
        for line in done.stdout.splitlines():
            if line.startswith("  FAILED "):
                table.add("Python: lies in " + name, line[9:])
        if done.returncode not in (0, 1) or (done.returncode and "FAILED" not in done.stdout):
            table.add("Python: lies in " + name, f"the process ended with {done.returncode}: {done.stderr[-300:]}")


def attack(options, table):
    """Runs each attack; a process that ends early is one wrong run."""
    python = options.build / "python/venv/bin/python"  # made by python/tests/environment.py
    if not python.exists():
        table.add("Python", "the package's environment is not built: cmake --build and ctest -R python.tests")
        return
    script = pathlib.Path(__file__).with_name("python_calls.py")
    paths = {**os.environ, "PYTHONPATH": str(options.build / "python/package")}
    for name in ATTACKS:
        folder = options.scratch / ("python-" + name)
        folder.mkdir()
        shutil.copy(options.inputs / "log.ply", folder)
        done = bounded.run([python, script, name, folder], folder, env=paths)
        if done.code == 0:
            for outcome, count in json.loads(done.out.splitlines()[-1]).items():
                table.add("Python: " + name, outcome, count=count)
        else:
            last = " / ".join(done.err.strip().splitlines()[-3:])
            table.add("Python: " + name, f"the process ended with {done.code}: {last}")
    lies(python, paths, table)
