#!/usr/bin/env python3
"""Roughness along the rings by class: prints, as JSON, for each number of the column `class` of the log REAL and for
REAL and each SIMULATED log of the same beams, the median of |r1 - 2 r2 + r3| (m) over three beams in a row of a ring
that all return and that all have this class in REAL, and the number of them."""
import argparse
import json

import numpy

from ply_columns import read


def triples(table):
    """Rows (n, 3) of three beams that follow each other in a ring of a scan."""
    order = numpy.lexsort((numpy.arange(len(table)), table["ring"], table["scan"]))
    rows = numpy.stack((order[:-2], order[1:-1], order[2:]), axis=1)
    same = [(table[c][rows] == table[c][rows[:, :1]]).all(axis=1) for c in ("scan", "ring")]
    return rows[same[0] & same[1]]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("real")
    parser.add_argument("simulated", nargs="+")
    parser.add_argument("--least", type=int, default=200, help="least number of differences of a class [200]")
    options = parser.parse_args()
    real, real_range = read(options.real)
    rows = triples(real)
    label = real["class"][rows]
    rows, label = rows[(label == label[:, :1]).all(axis=1)], label[(label == label[:, :1]).all(axis=1), 0]
    out = {}
    for name in (options.real, *options.simulated):
        ranges = real_range if name == options.real else read(name)[1]
        if len(ranges) != len(real_range):
            raise SystemExit(f"{name}: not the beams of {options.real}")
        r = ranges[rows]
        difference = numpy.abs(r[:, 0] - 2 * r[:, 1] + r[:, 2])
        for number in numpy.unique(label):
            of_class = difference[(label == number) & numpy.isfinite(difference)]
            if len(of_class) >= options.least:
                out.setdefault(str(number), {})[name] = {"m": float(numpy.median(of_class)), "count": len(of_class)}
    print(json.dumps(out))


if __name__ == "__main__":
    main()
