#!/usr/bin/env python3
"""Seconds, memory and bytes of jobs in one process, on four local Dask workers and on Slurm, with equal results.

    scripts/many_machines.py drive [--km2 100] [--km 2 20 200] --folder FOLDER     a drive through a composed forest
    scripts/many_machines.py logs LOG ... [--logs 1 8 64] --folder FOLDER          copies of logs, fitted to one model

Run it with a Python that has the package and `distributed`: PYTHONPATH=build/python/package build/python/venv/bin/python.

drive: a forest is generated in parts and composed of the built-in plants, and an OS1-64 drives on lanes through it at
10 m/s. There is a scan every --every metres (1 is each scan of the sensor at 10 Hz). logs: each copy of a log has the
first --beams rows, stands on one of --places places of a square, and has small errors of its pose (σ of 2 cm, and of
0.02° about the vertical); its model becomes a world of regions. Each number in --km or --logs is run in one process on
one thread, and the last one as a plan by each engine, whose result must have the bytes of the one process. The
exponents of processor time and memory against the number of beams are printed beside each number but the first.
"""
import argparse
import filecmp
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import time

import local_slurm

MIB = 1 << 20
SPEED_M_S, SCAN_S = 10, 0.1
HEIGHT_M, BORDER_M = 3, 200  # above the ground, and from the edge of the site
PART_M = 128


# A process begins with the peak memory of the one that started it, so that a small one must start what is measured.
START = """import json, os, subprocess, sys, time
start = time.monotonic()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
if status:
    sys.exit(1)
print(json.dumps({"seconds": time.monotonic() - start, "processor_s": usage.ru_utime + usage.ru_stime,
                  "peak_mib": usage.ru_maxrss / 1024}))"""


def cost(program, *words, folder="."):
    """Runs a command, and returns its seconds, processor seconds and peak memory."""
    done = subprocess.run([sys.executable, "-c", START, program, *map(str, words)], stdout=subprocess.PIPE, text=True,
                          cwd=folder, check=False)
    if done.returncode:
        raise SystemExit(f"{words[0]} failed")
    return json.loads(done.stdout)


def say(program, *words, folder="."):
    done = subprocess.run([program, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True, cwd=folder)
    return json.loads(done.stdout)


def bytes_of(path):
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())


def are_equal(a, b):
    """Whether two files, or all files of two folders, have the same bytes."""
    if a.is_file():
        return filecmp.cmp(a, b, shallow=False)
    names = [{file.relative_to(folder) for file in folder.rglob("*") if file.is_file()} for folder in (a, b)]
    return names[0] == names[1] and all(filecmp.cmp(a / name, b / name, shallow=False) for name in names[0])


class Table:
    """The rows of the table, each printed as soon as it is known."""

    def __init__(self, file):
        self.file, self.rows = file, []

    def add(self, **row):
        first = next((r for r in self.rows if r["what"] == row["what"] and r["beams"] and r["engine"] == row["engine"]), None)
        if first and row["beams"] > first["beams"]:
            growth = math.log(row["beams"] / first["beams"])
            for name, key in (("time_exponent", "processor_s"), ("memory_exponent", "peak_mib")):
                row[name] = math.log(row[key] / first[key]) / growth
        self.rows.append(row)
        print(" ".join(f"{name} {value:.2f}" if isinstance(value, float) else f"{name} {value}"
                       for name, value in row.items()), flush=True)
        if self.file:
            self.file.write_text(json.dumps(self.rows, indent=2) + "\n")


def by_dask(options, folder):
    from distributed import Client, LocalCluster

    from underbrush import dask

    with LocalCluster(n_workers=options.workers, threads_per_worker=1, processes=True, dashboard_address=":0") as cluster, \
            Client(cluster) as client:
        here = os.getcwd()
        os.chdir(folder)
        for future in dask.submit("plan", client):
            future.result()
        os.chdir(here)


def by_slurm(options, folder):
    slurm = local_slurm.LocalSlurm(folder, options.program, options.workers)
    try:
        slurm.start_all()
        script = subprocess.run([options.program, "plan", "--slurm", "plan"], check=True, stdout=subprocess.PIPE, text=True,
                                cwd=folder).stdout
        slurm.submit(script.rpartition("sbatch $after")[0], seconds=options.most_seconds)
    finally:
        slurm.stop()
        shutil.rmtree(folder / "bin")
        shutil.rmtree(folder / "slurm")


ENGINES = {"dask": by_dask, "slurm": by_slurm}


def run_plan(options, table, what, beams, command, expected):
    """Runs a command of the folder as a plan by each engine; its result must be equal to the one expected."""
    folder = expected.parent
    one = table.rows[-1]
    for engine in options.engines:
        result = folder / f"by-{engine}{expected.suffix}"
        (folder / "job.yaml").write_text(json.dumps({"command": [*command, "-o", result.name], "pieces": options.pieces}))
        start = time.monotonic()
        planned = cost(options.program, "plan", "job.yaml", "-o", "plan", folder=folder)
        ENGINES[engine](options, folder)
        seconds = time.monotonic() - start
        merged = cost(options.program, "merge", "plan", folder=folder)
        records = [json.loads(file.read_text()) for file in (folder / "plan/records").glob("*.json")]
        if not are_equal(result, expected):
            raise SystemExit(f"{what}: the result of {engine} is another one than that of one process")
        processor = planned["processor_s"] + merged["processor_s"] + sum(r["processor_s"] for r in records)
        table.add(what=what, engine=engine, beams=beams, seconds=seconds + merged["seconds"], processor_s=processor,
                  peak_mib=max(r["peak_memory_bytes"] for r in records) / MIB, merge_mib=merged["peak_mib"],
                  mb=bytes_of(folder / "plan") / 1e6 + bytes_of(result) / 1e6, tasks=len(records),
                  efficiency=one["processor_s"] / processor, equal=True)
        shutil.rmtree(folder / "plan")
        shutil.rmtree(result) if result.is_dir() else result.unlink()


def lane_points(half_m, km, every_m):
    """Places on lanes through a square: as many as a drive of some kilometres has at this distance."""
    reach = half_m - min(BORDER_M, half_m / 2)
    count = round(1000 * km / every_m)
    lanes = max(2, math.ceil(1000 * km / (2 * reach)))
    gap = 2 * reach / (lanes - 1)
    for k in range(count):
        lane, x = divmod(k * every_m, 2 * reach)
        yield (x - reach) * (-1 if int(lane) % 2 else 1), min(lane * gap - reach, reach)


def heights(site, half_m, places):
    """The height of the object nearest to each place."""
    parts = {}
    for x, y in places:
        key = f"{int((x + half_m) // PART_M)}_{int((y + half_m) // PART_M)}"
        if key not in parts:
            objects = json.loads((site / "parts" / f"{key}.json").read_text())["objects"]
            parts = {key: [o["position_m"] for o in objects]}
        yield min((math.hypot(px - x, py - y), pz) for px, py, pz in parts[key])[1]


def write_drive(file, site, half_m, km, every_m):
    """A drive of scans at places far apart: the sensor moves during a scan, and then stands at the next place."""
    places = list(lane_points(half_m, km, every_m))
    lines = []
    for k, ((x, y), z) in enumerate(zip(places, heights(site, half_m, places))):
        for time_s, moved in ((k * SCAN_S, 0), ((k + 1) * SCAN_S - 1e-6, SPEED_M_S * SCAN_S)):
            lines.append(f"{time_s:.6f} {x + moved:.3f} {y:.3f} {z + HEIGHT_M:.3f} 0 0 0 1\n")
    file.write_text("".join(lines))


def drive(options, table, folder):
    program, side = options.program, 1000 * math.sqrt(options.km2)
    site, world = folder / "site", folder / "world"
    generated = cost(program, "annotate", "--generate", "forest", "--density", 0.1, "--size", side, side, "--seed", 3,
                     "--ground-spacing", 2, "--parts", PART_M, "-o", site)
    table.add(what="annotate", engine="one process", beams=0, **generated, mb=bytes_of(site) / 1e6)
    composed = cost(program, "compose", site, options.primitives, "-o", world)
    table.add(what="compose", engine="one process", beams=0, **composed, mb=bytes_of(world) / 1e6)
    for km in options.km:
        write_drive(folder / f"drive{km:g}.txt", site, side / 2, km, options.every)
    shutil.rmtree(site)
    for km in options.km:
        command = ["simulate", "world", "--sensor", "ouster-os1-64", "--trajectory", f"drive{km:g}.txt"]
        one = folder / f"one{km:g}.ublog"
        costs = cost(program, *command, "--threads", 1, "-o", one.name, folder=folder)
        beams = say(program, "info", one, "--json", "-")["beams"]
        table.add(what="simulate", engine="one process", beams=beams, **costs, mb=bytes_of(one) / 1e6)
    run_plan(options, table, "simulate", beams, command, one)


def copy_of(log, k, options, file):
    """A copy of a log on its place, with the error of its pose."""
    import numpy as np

    import underbrush

    random = np.random.default_rng(k)
    row = math.ceil(math.sqrt(options.places))
    place = options.apart * np.array([k % options.places % row, k % options.places // row, 0])
    error, turn = random.normal(0, 0.02, 3), math.radians(random.normal(0, 0.02))
    rotation = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0], [0, 0, 1]])
    moved = log.slice(0, min(options.beams, len(log)))
    centre = moved.origin[0].copy()
    moved.origin[:] = (moved.origin - centre) @ rotation.T + place + error
    moved.direction[:] = moved.direction @ rotation.T.astype(np.float32)
    info = moved.info
    info.scans = []  # The poses of scans, which a fit without keyframes does not need, are not those of the copy.
    moved.info = info
    underbrush.write_log(file, moved)
    return len(moved)


def logs(options, table, folder):
    import underbrush

    beams, names = [], []
    given = [path.resolve() for path in options.log]
    for which, path in enumerate(given):  # one of the given logs is in memory at a time
        log = underbrush.read_log(path)
        for k in range(which, options.logs[-1], len(given)):
            beams.append((k, copy_of(log, k, options, folder / f"{k}.ublog")))
        del log
    beams = [n for _, n in sorted(beams)]
    for count in options.logs:
        names = [f"{k}.ublog" for k in range(count)]
        command = ["fit", *names, "--min-range", "2", "--keyframes", str(options.keyframes)]
        one = folder / f"one{count}"
        costs = cost(options.program, *command, "--threads", 1, "-o", one.name, folder=folder)
        table.add(what="fit", engine="one process", beams=sum(beams[:count]), logs=count, **costs, mb=bytes_of(one) / 1e6)
        if count != options.logs[-1]:
            shutil.rmtree(one)
    run_plan(options, table, "fit", sum(beams), command, one)
    costs = cost(options.program, "regions", one, "-o", folder / "world", "--side", 128)
    table.add(what="regions", engine="one process", beams=sum(beams), **costs, mb=bytes_of(folder / "world") / 1e6)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("--program", default="build/bin/underbrush", type=lambda path: str(pathlib.Path(path).resolve()))
    common.add_argument("--folder", type=pathlib.Path, required=True, help="a new folder for all files, which is removed")
    common.add_argument("--json", type=pathlib.Path)
    common.add_argument("--engines", nargs="*", choices=ENGINES, default=list(ENGINES))
    common.add_argument("--workers", type=int, default=4)
    common.add_argument("--pieces", type=int, default=8)
    common.add_argument("--most-seconds", type=float, default=7200, help="of a job on Slurm")
    commands = parser.add_subparsers(dest="command", required=True)
    of_drive = commands.add_parser("drive", parents=[common])
    of_drive.add_argument("--km2", type=float, default=100)
    of_drive.add_argument("--km", type=float, nargs="+", default=[2, 20, 200])
    of_drive.add_argument("--primitives", default="mesh_primitives", help="a set of plants")
    of_drive.add_argument("--every", type=float, default=100, help="m from scan to scan")
    of_logs = commands.add_parser("logs", parents=[common])
    of_logs.add_argument("log", nargs="+", type=pathlib.Path)
    of_logs.add_argument("--logs", type=int, nargs="+", default=[1, 8, 64])
    of_logs.add_argument("--beams", type=int, default=1_600_000, help="of each copy, at most")
    of_logs.add_argument("--places", type=int, default=6, help="a multiple of the number of logs: one log a place")
    of_logs.add_argument("--apart", type=float, default=400, help="m from place to place")
    of_logs.add_argument("--keyframes", type=int, default=0)
    options = parser.parse_args()
    if "slurm" in options.engines and (lacking := local_slurm.lacking()):
        print(f"no Slurm: {lacking}", file=sys.stderr)
        options.engines.remove("slurm")
    options.folder.mkdir(parents=True)
    try:
        {"drive": drive, "logs": logs}[options.command](options, Table(options.json), options.folder.resolve())
    finally:
        shutil.rmtree(options.folder)


if __name__ == "__main__":
    main()
