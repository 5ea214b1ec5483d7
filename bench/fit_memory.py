#!/usr/bin/env python3
"""Peak memory of `underbrush fit` on a log and on the same log repeated.

    bench/fit_memory.py LOG.ply [--times 1 2 4] [--program build/bin/underbrush] [--json FILE]

The log is repeated record by record (its ray cloud PLY rows written again). Memory must follow the
model and a tile, not the log: the factor from one size to the next is printed beside the log's.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile


def repeated(log, times, folder):
    data = log.read_bytes()
    head = data.index(b"end_header\n") + len(b"end_header\n")
    count = re.search(rb"element vertex +(\d+)", data[:head])
    wide = count.end(1) - count.start(1)
    number = str(int(count.group(1)) * times).encode()
    header = data[:count.start(1)] + number.rjust(wide) + data[count.end(1):head]
    out = folder / f"x{times}.ply"
    with out.open("wb") as f:
        f.write(header)
        for _ in range(times):
            f.write(data[head:])
    return out, int(number)


def peak_mib(program, log, model):
    child = subprocess.Popen([program, "fit", log, "-o", model], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"fit of {log} failed")
    return usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("log", type=pathlib.Path)
    parser.add_argument("--times", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--program", default="build/bin/underbrush")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for times in args.times:
            log, beams = repeated(args.log, times, pathlib.Path(folder))
            peak = peak_mib(args.program, log, pathlib.Path(folder) / "model")
            log.unlink()
            rows.append({"times": times, "beams": beams, "peak_mib": peak,
                         "factor": peak / rows[0]["peak_mib"] if rows else 1.0})
            print("log x{times}: {beams} beams, peak {peak_mib:.0f} MiB, {factor:.2f} of the first"
                  .format(**rows[-1]), flush=True)
    if args.json:
        args.json.write_text(json.dumps(rows, indent=2) + "\n")


main()
