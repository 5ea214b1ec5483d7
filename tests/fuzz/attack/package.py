"""Attacks on the Python package, each in a process of its own, which no call may end."""
import json
import os
import pathlib
import shutil

import bounded

ATTACKS = ("strides", "kinds", "spoiled", "lifetimes", "forks", "interrupted", "shared")


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
