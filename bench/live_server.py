#!/usr/bin/env python3
"""Measures the sensor server `underbrush live` as a client sees it: from the request to the arrays, with boxes that
drive around the sensor.

  pip install grpcio grpcio-tools numpy
  PYTHONPATH=build/python/package bench/live_server.py MODEL LOG                  latencies (a minute or two)
  PYTHONPATH=build/python/package bench/live_server.py MODEL LOG --minutes 30     and a soak at the sensor's rate
  PYTHONPATH=build/python/package bench/live_server.py MODEL LOG --actors DIR     with actors that `actors` learnt

Prints quantiles and a histogram of the latencies of whole revolutions and of tenths of one, in columns and as the
bytes of a PointCloud2, and their jitter: the mean difference between a latency and the next. The soak asks for a
revolution when it is due, and prints how many were late and the server's memory at its start and end."""
from __future__ import annotations

import argparse
import collections
import itertools
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time
from typing import Any

import numpy as np
import numpy.typing as npt

import underbrush
from underbrush.cli import program

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "share" / "live"))
from underbrush_live import SensorServer, pose  # noqa: E402

BOX = "".join(f"v {x} {y} {z}\n" for x in (-2.2, 2.2) for y in (-0.9, 0.9) for z in (0, 1.5)) + "".join(
    f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in (
        (1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (2, 6, 8, 4), (1, 3, 7, 5)))
SPEED = 3.0  # m/s, of the sensor
WARM_UP = 20  # firings that are not counted


class Drive:
    """Where the sensor and what moves are: it goes along the log's way and back, and they drive around it."""

    def __init__(self, log: str, names: list[str]) -> None:
        self.way = underbrush.read_log(log).origin[::1000]
        steps = np.linalg.norm(np.diff(self.way, axis=0), axis=1)
        self.along = np.concatenate([[0.0], np.cumsum(steps)])
        self.names = names

    def sensor(self, time_s: float) -> Any:
        """Its pose."""
        length = max(self.along[-1], 1e-9)
        turns, at = divmod(SPEED * time_s, length)
        at = length - at if turns % 2 else at
        return pose([float(np.interp(at, self.along, self.way[:, c])) for c in range(3)])

    def movers(self, time_s: float) -> dict[str, Any]:
        """Their poses: on circles of 6 m and more about the sensor, on the ground."""
        here, out = self.sensor(time_s), {}
        for k, name in enumerate(self.names):
            radius, angle = 6 + 3 * k, 2.4 * k + 8 / (6 + 3 * k) * time_s
            heading = angle + math.pi / 2
            out[name] = pose((here.x + radius * math.cos(angle), here.y + radius * math.sin(angle), here.z - 1.8),
                             (0, 0, math.sin(heading / 2), math.cos(heading / 2)))
        return out


def what_moves(options: argparse.Namespace, folder: pathlib.Path) -> tuple[list[str], list[str]]:
    """The names of what moves, and the options of `live` for it: boxes, or copies of learnt actors in turn."""
    if not options.actors:
        mesh = folder / "box.obj"
        mesh.write_text(BOX, encoding="utf-8")
        names = [f"box{k}" for k in range(options.boxes)]
        return names, [word for name in names for word in ("--mover", f"{name}={mesh}")]
    scene = json.loads((options.actors / "scene.json").read_text(encoding="utf-8"))
    learnt = [model["name"] for model in scene["models"]]
    names = [f"actor{k}" for k in range(options.boxes)]
    edits = [{"edit": "copy", "actor": learnt[k % len(learnt)], "as": name} for k, name in enumerate(names)]
    edits += [{"edit": "remove", "actor": name} for name in learnt]
    file = folder / "edits.json"
    file.write_text(json.dumps({"format": "underbrush-actor-edits", "version": 1,
                                "actors": str(options.actors.resolve()), "edits": edits}), encoding="utf-8")
    return names, ["--actors", str(file)]


def fire(client: SensorServer, drive: Drive, until_s: float, layout: str) -> float:
    """Fires up to a time, and returns the seconds from the request to the arrays."""
    where = drive.sensor(until_s), drive.movers(until_s)
    start = time.perf_counter()
    if not layout:
        client.fire(until_s, *where)
    else:
        collections.deque(client.parts(until_s, *where, layout=layout), maxlen=0)
    return time.perf_counter() - start


def processor_s(process: int) -> float:
    """Processor time that a process has used, s."""
    words = pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def latencies(client: SensorServer, drive: Drive, step_s: float, rounds: int, layout: str) -> npt.NDArray[np.float64]:
    """The seconds of each firing, one asked for after the other."""
    out = [fire(client, drive, client.time_s + step_s, layout) for _ in range(WARM_UP + rounds)]
    return np.array(out[WARM_UP:])


def tell(what: str, times_s: npt.NDArray[np.float64]) -> None:
    """Prints a row of the table, and the histogram below it."""
    ms = 1e3 * times_s
    quantiles = "   ".join(f"{name} {value:6.2f}" for name, value in zip(
        ("median", "95 %", "99 %", "99.9 %", "largest"), np.percentile(ms, [50, 95, 99, 99.9, 100]), strict=True))
    print(f"{what:<28} {quantiles}   jitter {np.abs(np.diff(ms)).mean():5.2f} ms", flush=True)
    low = math.floor(math.log2(ms.min()) * 4)
    edges = 2.0 ** (np.arange(low, math.ceil(math.log2(ms.max()) * 4) + 1) / 4)
    counts, _ = np.histogram(ms, edges)
    print("    " + "   ".join(f"{a:.1f}-{b:.1f} ms: {n}" for a, b, n in zip(edges, edges[1:], counts, strict=False) if n),
          flush=True)


def soak(client: SensorServer, drive: Drive, step_s: float, minutes: float, process: int) -> None:
    """Asks for each revolution when it is due, and prints latencies, delays and memory."""
    def resident_mb() -> float:
        """Resident memory of the server, MB."""
        return int(pathlib.Path(f"/proc/{process}/statm").read_text(encoding="utf-8").split()[1]) * 4096 / 1e6

    times, late, begin = [], 0, time.perf_counter()
    before = most = 0.0
    for k in range(round(60 * minutes / step_s)):
        due = begin + k * step_s
        time.sleep(max(0.0, due - time.perf_counter()))
        times.append(fire(client, drive, client.time_s + step_s, ""))
        late += time.perf_counter() > due + step_s
        most = max(most, resident_mb())
        before = most if k == WARM_UP else before
    tell(f"soak, {minutes:g} minutes", np.array(times[WARM_UP:]))
    print(f"    {len(times)} revolutions at {1 / step_s:g} Hz, {late} of them late; the server's memory is {before:.1f} MB "
          f"at the start, {resident_mb():.1f} MB at the end and at most {most:.1f} MB")


def main() -> None:
    """Prints the latencies."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("log", help="the sensor goes along the way of its beams")
    parser.add_argument("--program", default=program(), help="the program underbrush (default: that of the package)")
    parser.add_argument("--sensor", default="ouster-os1-128")
    parser.add_argument("--boxes", type=int, default=10, help="how many boxes, or actors, move")
    parser.add_argument("--actors", type=pathlib.Path, help="a folder that `underbrush actors` wrote, instead of boxes")
    parser.add_argument("--rounds", type=int, default=1000, help="firings of each kind")
    parser.add_argument("--layout", default="ouster", help="of the point clouds")
    parser.add_argument("--minutes", type=float, default=0, help="of the soak")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        names, movers = what_moves(options, pathlib.Path(folder))
        drive = Drive(options.log, names)
        with subprocess.Popen([options.program, "live", options.model, "--sensor", options.sensor, *movers, "--json", "-"],
                              stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            reply = "".join(itertools.takewhile(lambda line: line != "}\n", server.stdout))
            if not reply:
                sys.exit("the server did not start")
            started = json.loads(reply + "}")
            try:
                client = SensorServer(started["address"], started["token"], 0.0, drive.sensor(0), **drive.movers(0))
                told = client.describe().sensors[0]
                print(f"{told.model}, {told.beams_per_revolution:.0f} beams a revolution, {len(names)} {'actors' if options.actors else 'boxes'}, "
                      f"{underbrush.threads()} threads")
                for layout in ("", options.layout):
                    for name, part in (("a revolution", 1), ("a tenth of one", 10)):
                        step_s = 1 / told.rate_hz / part
                        before = processor_s(server.pid)
                        times = latencies(client, drive, step_s, options.rounds, layout)
                        used = (processor_s(server.pid) - before) / (WARM_UP + options.rounds)
                        tell(f"{name}, {layout or 'columns'}", times)
                        print(f"    {1e3 * used:.1f} ms of the server's processor time", flush=True)
                if options.minutes > 0:
                    soak(client, drive, 1 / told.rate_hz, options.minutes, server.pid)
            finally:
                server.terminate()


if __name__ == "__main__":
    main()
