#!/usr/bin/env python3
"""Seconds, processor seconds and peak memory of a generated forest by its area, as a world of regions.

    scripts/world_costs.py PRIMITIVES [--km2 1 10 100] [--program build/bin/underbrush] [--json FILE]

The forest is generated in parts and composed of the set of primitives, and an OS1-64 drives 10 s on a straight way of
100 m through its middle. The exponents of processor time and memory against area, from the first size on, are printed beside
each other size.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile
import time


def cost(program, *words):
    """Seconds, seconds of processors and peak memory (MiB) of a command."""
    start = time.monotonic()
    child = subprocess.Popen([program, *map(str, words)], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{words[0]} failed")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def costs_of(program, primitives, km2, folder):
    side = 1000 * math.sqrt(km2)
    poses = folder / "poses.txt"
    poses.write_text("0 0 0 3 0 0 0 1\n10 100 0 3 0 0 0 1\n")
    return {
        "annotate": cost(program, "annotate", "--generate", "forest", "--density", 0.1, "--size", side, side, "--seed",
                         3, "--ground-spacing", 2, "--parts", 128, "-o", folder / "site"),
        "compose": cost(program, "compose", folder / "site", primitives, "-o", folder / "world"),
        "simulate": cost(program, "simulate", folder / "world", "--sensor", "ouster-os1-64", "--trajectory", poses,
                         "-o", folder / "log.ublog"),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("primitives", type=pathlib.Path)
    parser.add_argument("--km2", type=float, nargs="+", default=[1, 10, 100])
    parser.add_argument("--program", default="build/bin/underbrush")
    parser.add_argument("--folder", help="where the worlds are written for a time (10 GB for 100 km²)")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    rows = []
    for km2 in args.km2:
        folder = pathlib.Path(tempfile.mkdtemp(dir=args.folder))
        try:
            costs = costs_of(args.program, args.primitives, km2, folder)
        finally:
            shutil.rmtree(folder)
        for verb, (seconds, processor, mib) in costs.items():
            row = {"km2": km2, "verb": verb, "seconds": seconds, "processor_seconds": processor, "peak_mib": mib}
            first = next((r for r in rows if r["verb"] == verb), None)
            if first:
                area = math.log(km2 / first["km2"])
                row["time_exponent"] = math.log(processor / first["processor_seconds"]) / area
                row["memory_exponent"] = math.log(mib / first["peak_mib"]) / area
            rows.append(row)
            print(" ".join(f"{name} {value:.2f}" if isinstance(value, float) else f"{name} {value}"
                           for name, value in row.items()), flush=True)
    if args.json:
        args.json.write_text(json.dumps(rows, indent=2) + "\n")


main()
