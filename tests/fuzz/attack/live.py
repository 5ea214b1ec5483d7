"""Attacks on the sensor server `underbrush live`, each in a process of its own that has grpcio (`live_calls.py`)."""
import json
import pathlib
import subprocess
import sys

ATTACKS = ("fields", "damaged", "sizes", "connections", "tokens", "readers", "cancelled", "many", "worlds", "killed")
WALL_S = 600
SCRIPT = pathlib.Path(__file__).with_name("live_calls.py")


def python_with_grpc(build):
    """A Python that has grpcio and its compiler of messages: this one, or that of the package's tests."""
    for python in (sys.executable, build / "python/venv/bin/python"):
        if python == sys.executable or python.exists():
            if subprocess.run([python, "-c", "import grpc, grpc_tools, numpy"], capture_output=True, check=False).returncode == 0:
                return python
    return None


def why_left_out(options, python):
    if not (options.program.parents[1] / "lib/underbrush/live_grpc.so").exists():
        return "the server is not built: make live"
    if python is None:
        return "grpcio and grpcio-tools are not installed: pip install 'underbrush[live]'"
    return None


def attack(options, table):
    """Runs each attack; a process that ends early is one wrong run."""
    python = python_with_grpc(options.build)
    reason = why_left_out(options, python)
    if reason:
        print("live is left out: " + reason, file=sys.stderr)
        return
    for name in ATTACKS:
        folder = options.scratch / ("live-" + name)
        folder.mkdir()
        for needed in ("model", "van.obj", "spinning.yaml"):
            (folder / needed).symlink_to(options.inputs / needed)
        try:
            done = subprocess.run([python, SCRIPT, name, folder, options.program, str(options.seed)], text=True,
                                  capture_output=True, timeout=WALL_S, check=False)
        except subprocess.TimeoutExpired:
            table.add("live: " + name, f"no end within {WALL_S} s")
            continue
        if done.returncode == 0:
            for outcome, count, what in json.loads(done.stdout.splitlines()[-1]):
                table.add("live: " + name, outcome, what, count)
        else:
            table.add("live: " + name, f"the process ended with {done.returncode}: " + " / ".join(done.stderr.splitlines()[-3:]))
