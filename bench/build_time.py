#!/usr/bin/env python3
"""Seconds of a build from nothing: for the program, the studies and everything else, for each target and each unit.

    bench/build_time.py [--jobs N] [--parts program studies rest] [--units N] [--json FILE] [-- cmake options]

Each part is built after the one before it, in a fresh folder without ccache, with the flags of `make build`.
Wall seconds depend on what else the machine does; CPU seconds (user and system, all cores) hardly do.
"""
import argparse
import collections
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
PARTS = {
    "program": ("OFF", "OFF", ["--target", "underbrush"]),
    "studies": ("ON", "OFF", ["--target", "underbrush-study"]),
    "rest": ("ON", "ON", []),
}


def record(log, command):
    """Runs one compiler command and appends what it took to `log`: this script as the compiler's launcher."""
    begin = time.monotonic()
    child = subprocess.Popen(command)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    output = command[command.index("-o") + 1] if "-o" in command else command[-1]
    line = json.dumps({"output": output, "wall": time.monotonic() - begin, "cpu": used.ru_utime + used.ru_stime,
                       "memory_mb": used.ru_maxrss / 1024})
    with open(log, "a", encoding="utf-8") as file:
        file.write(line + "\n")
    return child.returncode


def target_of(output):
    """The target of an object or program: `x/CMakeFiles/NAME.dir/a.cpp.o` belongs to NAME."""
    for part in Path(output).parts:
        if part.endswith(".dir"):
            return part[:-len(".dir")]
    return "link " + Path(output).name


def quiet(command):
    """Runs a command, shows its output only if it fails, and returns its wall seconds."""
    begin = time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        sys.exit(done.stdout + f"\nfailed: {' '.join(command)}")
    return time.monotonic() - begin


def build(build_dir, part, options):
    """Builds one part; returns its wall seconds and what each command took."""
    studies, tests, target = PARTS[part]
    log = build_dir / f"{part}.log"
    launcher = f"{sys.executable};{Path(__file__).resolve()};--record;{log}"
    wall = quiet(["cmake", "-S", str(options.source), "-B", str(build_dir), "-G", "Ninja",
                  "-DCMAKE_BUILD_TYPE=Release", f"-DUNDERBRUSH_STUDIES={studies}", f"-DUNDERBRUSH_TESTS={tests}",
                  f"-DUNDERBRUSH_BENCH={tests}", f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}",
                  f"-DCMAKE_CXX_LINKER_LAUNCHER={launcher}", *options.cmake])
    wall += quiet(["cmake", "--build", str(build_dir), "-j", str(options.jobs), *target])
    lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
    return wall, [json.loads(line) for line in lines]


def show(part, wall, units, count):
    """The tables of one part."""
    print(f"{part}: {wall:.0f} s wall, {sum(u['cpu'] for u in units):.0f} s CPU, {len(units)} commands")
    targets = collections.defaultdict(lambda: [0.0, 0.0, 0])
    for unit in units:
        entry = targets[target_of(unit["output"])]
        entry[0] += unit["cpu"]
        entry[1] += unit["wall"]
        entry[2] += 1
    print(f"  {'CPU s':>8} {'wall s':>8} {'commands':>8}  target")
    for name, (cpu, seconds, commands) in sorted(targets.items(), key=lambda item: -item[1][0]):
        print(f"  {cpu:8.1f} {seconds:8.1f} {commands:8}  {name}")
    if count:
        print(f"  {'CPU s':>8} {'wall s':>8} {'MB':>8}  unit")
    for unit in sorted(units, key=lambda u: -u["cpu"])[:count]:
        name = unit["output"].replace("CMakeFiles/", "")
        print(f"  {unit['cpu']:8.1f} {unit['wall']:8.1f} {unit['memory_mb']:8.0f}  {name}")


def main():
    """Builds and prints."""
    if len(sys.argv) > 3 and sys.argv[1] == "--record":
        sys.exit(record(sys.argv[2], sys.argv[3:]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", default=SOURCE, type=Path, help="the checkout to build")
    parser.add_argument("--jobs", "-j", default=os.cpu_count(), type=int)
    parser.add_argument("--parts", nargs="+", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--units", default=0, type=int, help="show the N slowest units of each part")
    parser.add_argument("--json", type=Path, help="write every command's seconds there")
    parser.add_argument("--keep", type=Path, help="build in this new folder and keep it")
    parser.add_argument("cmake", nargs="*", help="options for cmake, after --")
    options = parser.parse_args()
    everything = {}
    with tempfile.TemporaryDirectory(prefix="underbrush-build-") as folder:
        build_dir = options.keep or Path(folder)
        if options.keep and options.keep.exists():
            parser.error(f"{options.keep} exists already: name a folder that does not")
        for part in options.parts:
            wall, units = build(build_dir.resolve(), part, options)
            build_dir.mkdir(exist_ok=True)
            show(part, wall, units, options.units)
            everything[part] = {"wall": wall, "commands": units}
    if options.json:
        options.json.write_text(json.dumps(everything, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
