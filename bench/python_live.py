#!/usr/bin/env python3
"""Times the Python package: a live sensor in a model, and what a call from Python costs.

    underbrush demo --only site -o demo
    bench/python_live.py demo/likelihood demo/test.ply

prints the time of `Lidar.scan`, from the call to the arrays, for one revolution with and without a moving object; the
time of `simulate` in Python beside the seconds that the program reports for the same beams and files, in pairs; what a
view costs; and the memory that views and scans add."""
from __future__ import annotations

import argparse
import gc
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

import underbrush
from underbrush.cli import program

BOX = "v 0 -1 -1\nv 0 1 -1\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 1 3 4\n"


def quantiles(times_s: list[float]) -> str:
    """Median, 99th percentile and largest, ms."""
    middle, high, most = np.percentile(1e3 * np.array(times_s), [50, 99, 100])
    return f"median {middle:7.2f} ms   99 % {high:7.2f} ms   largest {most:7.2f} ms"


def poses_in(log: underbrush.BeamLog) -> list[underbrush.Pose]:
    """Level poses at origins of beams all over the log."""
    return [underbrush.Pose(origin) for origin in log.origin[:: max(1, len(log) // 50)]]


def time_scans(lidar: underbrush.Lidar, poses: list[underbrush.Pose],
               rounds: int) -> tuple[list[float], float, int, float]:
    """Seconds of each scan, share of hits, beams of a scan, seconds of CPU time of a scan."""
    times, hits, beams = [], 0, 0
    cpu = time.process_time()
    for k in range(rounds):
        a = poses[k % len(poses)]
        b = underbrush.Pose(a.position + [0.3, 0, 0])
        start = time.perf_counter()
        scan = lidar.scan(a, b, 0.1 * k)
        times.append(time.perf_counter() - start)
        hits += int(np.isfinite(scan.range_m).sum())
        beams += len(scan)
    cpu = time.process_time() - cpu
    return times[2:], hits / max(beams, 1), beams // rounds, cpu / rounds


def overhead(model: str, log: str, rounds: int) -> None:
    """Times `simulate` of Python and of the program in turn, from file to file; Python has read the model before."""
    value = underbrush.read_model(model)
    ratios, whole, ours = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            start = time.perf_counter()
            underbrush.simulate(value, like=log, output=f"{folder}/a.ply")
            mine = time.perf_counter() - start
            start = time.perf_counter()
            read = subprocess.run([program(), "simulate", model, "--like", log, "-o", f"{folder}/b.ply", "--json", "-"],
                                  check=True, capture_output=True, text=True)
            whole.append(mine / (time.perf_counter() - start))
            ratios.append(mine / json.loads(read.stdout)["seconds"])
            ours.append(mine)
    print(f"simulate    {np.median(ours):.3f} s in Python, {np.median(ratios):.3f} of the seconds that the program "
          f"reports ({min(ratios):.3f} to {max(ratios):.3f}), {np.median(whole):.3f} of its process")
    empty = underbrush.BeamLog(0)
    start = time.perf_counter()
    for _ in range(100_000):
        empty.range_m  # a view  # noqa: B018
    print(f"view        {(time.perf_counter() - start) / 1e5 * 1e9:.0f} ns for a column of a log")


def resident_mb() -> float:
    """Resident memory of this process, MB."""
    return int(pathlib.Path("/proc/self/statm").read_text(encoding="utf-8").split()[1]) * 4096 / 1e6


def copies(lidar: underbrush.Lidar, pose: underbrush.Pose) -> None:
    """Prints the memory that views of a large log add, and that a live sensor's scans leave behind."""
    log = underbrush.BeamLog(5_000_000)
    names = ("origin", "direction", "range_m", "intensity", "time_s", "ring", "scan", "packet", "flags")
    held = [getattr(log, name) for name in names]
    for column in held:
        column[:] = 0
    size, before = sum(column.nbytes for column in held) / 1e6, resident_mb()
    views = [getattr(log, name) for name in names for _ in range(100)]
    print(f"copies      {len(views)} views of a log of {size:.0f} MB add {resident_mb() - before:.1f} MB")
    for _ in range(20):
        lidar.scan(pose)
    gc.collect()
    before = resident_mb()
    for _ in range(200):
        lidar.scan(pose)
    gc.collect()
    print(f"            200 scans that are not kept add {resident_mb() - before:.1f} MB")


def main() -> None:
    """Prints the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("log", help="its beams say where the sensor may stand")
    parser.add_argument("--sensor", default="velodyne-vlp16")
    parser.add_argument("--rounds", type=int, default=300)
    parser.add_argument("--pairs", type=int, default=15, help="runs of simulate in Python and in the program")
    options = parser.parse_args()
    log = underbrush.read_log(options.log)
    poses = poses_in(log)
    world = underbrush.read_model(options.model)
    print(f"{world}, {options.sensor}, {underbrush.threads()} threads")
    with tempfile.TemporaryDirectory() as folder:
        mesh = f"{folder}/box.obj"
        with open(mesh, "w", encoding="utf-8") as file:
            file.write(BOX)
        middle = log.origin.mean(axis=0)
        way = underbrush.Trajectory(np.array([0.0, 60.0]), np.array([middle - [20, 0, 0], middle + [20, 0, 0]]),
                                    np.tile([0.0, 0, 0, 1], (2, 1)))
        for name, movers in (("still", []), ("1 mover", [(mesh, way, "")])):
            lidar = underbrush.Lidar(world, options.sensor, movers=movers)
            times, hits, beams, cpu = time_scans(lidar, poses, options.rounds)
            print(f"{name:<11} {quantiles(times)}   {1e3 * cpu:.2f} ms of CPU time   {beams} beams, {hits:.0%} hits")
    copies(lidar, poses[0])
    overhead(options.model, options.log, options.pairs)


if __name__ == "__main__":
    main()
