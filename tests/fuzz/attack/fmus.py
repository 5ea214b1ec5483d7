"""Attacks on the FMUs, each in a process of its own, which the FMU must not end."""
import json
import pathlib
import sys

import bounded

ATTACKS = ("in_any_order", "addresses", "states", "threads", "instances")


def attack(options, table):
    """Runs each attack; a process that ends early is one wrong run."""
    archives = [options.build / name for name in ("underbrush.fmu", "underbrush3.fmu")]
    script = pathlib.Path(__file__).with_name("fmu_calls.py")
    for name in ATTACKS:
        done = bounded.run([sys.executable, script, *archives, name, options.seed], options.scratch)
        if done.code == 0:
            for outcome, count in json.loads(done.out).items():
                table.add("FMU: " + name.replace("_", " "), outcome, count=count)
        else:
            last = (done.err.strip().splitlines() or [""])[-1]
            table.add("FMU: " + name.replace("_", " "), f"the process ended with {done.code}: {last}", "")
