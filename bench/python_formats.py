#!/usr/bin/env python3
"""Speed and memory of the Python readers beside the libraries alone, as a Markdown table.

    PYTHONPATH=build/python/package bench/python_formats.py [--scans 20] [--repeats 5] [--only laz mcap ...]

Files of every format are written from a generated log (128 rings, 1024 columns, 30 % misses; about 2.6 million beams).
Each measurement runs in a process of its own, ours and the library's in turn; the fastest of the repeats counts. Speeds
are per second of CPU (user and system, all threads), because wall seconds depend on what else the machine does.
"Library alone" decodes all points or messages and does nothing with them; ours yields scans with all columns, and
"placed" also gives each beam its pose in the world. Memory is the growth of the process.
"""
import argparse
import importlib
import json
import os
import pathlib
import resource
import sys
import tempfile
import time

import numpy as np

from underbrush.formats import Poses, beams, open_recording
from underbrush.formats.trajectory import pose_at, rotate

RINGS, COLUMNS = 128, 1024
FORMATS = {
    # name: (file, what is kept, library)
    "las": ("log.las", "times, rings (extra), returns, intensity, class; no misses", "laspy"),
    "laz": ("log.laz", "times, rings (extra), returns, intensity, class; no misses", "laspy, lazrs"),
    "ros1": ("log.bag", "misses, times, rings, intensity", "rosbags"),
    "sqlite3": ("log.db3", "misses, times, rings, intensity", "rosbags"),
    "mcap": ("log.mcap", "misses, times, rings, intensity", "rosbags"),
    "mcap zstd": ("packed.mcap", "misses, times, rings, intensity", "rosbags"),
    "e57": ("log.e57", "misses with a direction, intensity, rows and columns", "pye57"),
    "xyz": ("log.xyz", "times, returns, intensity, class; no misses", "NumPy"),
    "npz": ("log.npz", "everything", "NumPy"),
}


def scan(number, poses):
    """Columns of one generated scan, in order of time."""
    rng = np.random.default_rng(number)
    n = RINGS * COLUMNS
    time_s = 0.1 * number + np.repeat(np.arange(COLUMNS) * (0.1 / COLUMNS), RINGS)
    ring = np.tile(np.arange(RINGS, dtype=np.uint16), COLUMNS)
    azimuth = np.repeat(-2 * np.pi * np.arange(COLUMNS) / COLUMNS, RINGS)
    elevation = np.deg2rad(np.linspace(45, -45, RINGS))[ring]
    direction = np.column_stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth),
                                 np.sin(elevation)])
    # Ranges vary smoothly, as those of real scans do, or compression would have nothing to find.
    range_m = (10 + 5 * np.sin(3 * azimuth) + 3 * np.cos(8 * elevation) + 0.02 * rng.normal(size=n)).astype(np.float32)
    miss = rng.random(n) < 0.3
    range_m[miss] = np.inf
    position, rotation, _ = pose_at(poses, time_s)
    return {"origin": position, "direction": rotate(rotation, direction).astype(np.float32), "range_m": range_m,
            "intensity": np.where(miss, 0, rng.integers(1, 200, n)).astype(np.float32), "time_s": time_s, "ring": ring,
            "scan": np.full(n, number, np.uint32), "packet": np.zeros(n, np.uint32), "flags": np.zeros(n, np.uint8)}


def trajectory(scans):
    time_s = np.linspace(0, 0.1 * scans, 10 * scans + 1)
    none = np.tile([0.0, 0.0, 0.0, 1.0], (len(time_s), 1))
    return Poses(time_s, np.column_stack([5 * time_s, 0 * time_s, 0 * time_s]), none)


def write(name, path, scans):
    poses = trajectory(scans)
    if name in ("e57", "xyz"):
        return write_points(name, path, scans, poses)
    if name == "npz":
        from underbrush.formats.numpy_log import NumpyLogWriter
        writer = NumpyLogWriter(path)
    elif name in ("las", "laz"):
        from underbrush.formats.write_las import LasWriter
        writer = LasWriter(path)
    else:
        from underbrush.formats.write_bag import BagWriter
        writer = BagWriter(path, poses, layout="ouster", compress="zstd" in name)
    with writer:
        for number in range(scans):
            writer.write(scan(number, poses))
    return None


def write_points(name, path, scans, poses):
    parts = [scan(number, poses) for number in range(scans if name == "e57" else max(1, scans // 4))]
    log = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    hit = np.isfinite(log["range_m"])
    xyz = np.where(hit, log["range_m"], 1).astype(np.float64)[:, None] * log["direction"]
    if name == "e57":
        import pye57
        rows = np.arange(len(hit))
        file = pye57.E57(str(path), mode="w")
        file.write_scan_raw({"cartesianX": xyz[:, 0], "cartesianY": xyz[:, 1], "cartesianZ": xyz[:, 2],
                             "cartesianInvalidState": (~hit).astype(np.int8), "intensity": log["intensity"],
                             "rowIndex": rows % RINGS, "columnIndex": rows // RINGS})
        file.close()
        return
    one = np.ones(np.count_nonzero(hit))
    table = np.column_stack([xyz[hit], log["intensity"][hit], 0 * one, one, one, np.flatnonzero(hit), one, 2 * one,
                             log["time_s"][hit]])
    np.savetxt(path, table, ["%.4f"] * 5 + ["%d"] * 5 + ["%.4f"])


def read_ours(path, scans, placed):
    recording = open_recording(path)
    if not placed:
        return sum(len(one) for one in recording.scans())
    poses = trajectory(scans) if recording.world else None
    return sum(len(one["range_m"]) for one in beams(recording, poses=poses))


def read_library(name, path):
    if name in ("las", "laz"):
        import laspy
        return len(laspy.read(path).points)
    if name == "e57":
        import pye57
        return len(pye57.E57(str(path)).read_scan_raw(0)["cartesianX"])
    if name == "xyz":
        return len(np.loadtxt(path))
    if name == "npz":
        with np.load(path) as arrays:
            return len([arrays[key] for key in arrays][0])
    from rosbags.highlevel import AnyReader
    points = 0
    with AnyReader([path]) as reader:
        for connection, _, raw in reader.messages([c for c in reader.connections if c.topic == "/points"]):
            cloud = reader.deserialize(raw, connection.msgtype)
            points += cloud.width * cloud.height
    return points


def in_child(function, *arguments):
    """What a function returns, the CPU seconds it takes and the MB by which its process grows: a process of its own."""
    inward, outward = os.pipe()
    child = os.fork()
    if child == 0:
        begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        start = time.process_time()
        result = function(*arguments)
        seconds = time.process_time() - start
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - begin) / 1024
        os.write(outward, json.dumps([result, seconds, grown]).encode())
        os._exit(0)
    os.close(outward)
    with os.fdopen(inward) as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    if not text:
        sys.exit("a measurement failed")
    return json.loads(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scans", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", nargs="+", choices=list(FORMATS), default=list(FORMATS))
    options = parser.parse_args()
    for module in ("laspy", "lazrs", "pye57", "rosbags.highlevel", "underbrush.formats.bag", "underbrush.formats.las",
                   "underbrush.formats.e57", "underbrush.formats.numpy_log"):
        importlib.import_module(module)  # No process measures the time that this takes.
    print("| format | kept | library | M points | ours, M/s | placed, M/s | library alone, M/s | ours, MB | "
          "library, MB |\n|---|---|---|---|---|---|---|---|---|")
    for name in options.only:
        file, kept, library = FORMATS[name]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / file
            in_child(write, name, path, options.scans)
            runs = [[in_child(read_ours, path, options.scans, False), in_child(read_ours, path, options.scans, True),
                     in_child(read_library, name, path)] for _ in range(options.repeats)]
        points = runs[0][0][0]
        speed = [points / min(run[k][1] for run in runs) / 1e6 for k in range(3)]
        memory = [min(run[k][2] for run in runs) for k in (0, 2)]
        print(f"| {name} | {kept} | {library} | {points / 1e6:.2f} | " + " | ".join(f"{v:.2f}" for v in speed)
              + f" | {memory[0]:.0f} | {memory[1]:.0f} |", flush=True)


if __name__ == "__main__":
    main()
