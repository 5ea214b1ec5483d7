#!/usr/bin/env python3
"""Counts what beams meet that met an actor before it was edited. All logs have the beams of LOG, whose returns of actors
are marked; the simulated ones have the columns of `simulate --element-ids --support`. Prints JSON."""
import argparse
import json
import pathlib

import numpy

import ply_columns

MOVER = 2       # the flag of returns of things that moved
NEAR_M = 0.3    # how near the returns of other scans must be
KNOWN, UNKNOWN = 0.9, 0.5  # support from which on space is known, and below which it is unknown


def ends_of(table, ranges):
    """Where beams end, world frame, m: (rows, 3); NaN without a return."""
    return numpy.column_stack([table[axis] for axis in "xyz"]) + 0 * ranges[:, None]


def cells_of(places):
    """The numbers of cells of NEAR_M, one for each place."""
    cell = numpy.floor(places / NEAR_M).astype(numpy.int64)
    return (cell[:, 0] << 42) + (cell[:, 1] << 21) + cell[:, 2]


def near_any(places, cells):
    """Which places have one of the sorted `cells` as their own or as a neighbour."""
    out = numpy.zeros(len(places), bool)
    for shift in numpy.ndindex(3, 3, 3):
        out |= numpy.isin(cells_of(places + NEAR_M * (numpy.array(shift) - 1)), cells)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("log", type=pathlib.Path)
    parser.add_argument("actors", type=pathlib.Path, help="the folder of the actors")
    parser.add_argument("replay", type=pathlib.Path, help="the log simulated with them")
    parser.add_argument("edited", nargs="+", help="ACTOR=LOG: the log simulated with an edit of the actor")
    arguments = parser.parse_args()
    names = [model["name"] for model in json.loads((arguments.actors / "scene.json").read_text())["models"]]
    real, real_m = ply_columns.read(arguments.log)
    still = numpy.isfinite(real_m) & (real["flags"] & MOVER == 0)
    cells = numpy.unique(cells_of(ends_of(real, real_m)[still]))
    replay, _ = ply_columns.read(arguments.replay)
    out = {}
    for words in arguments.edited:
        name, _, path = words.partition("=")
        instances = [k + 1 for k, other in enumerate(names) if other == name]
        edited, edited_m = ply_columns.read(path)
        is_there = "removed" not in pathlib.Path(path).stem
        met = numpy.isin(replay["instance"], instances)
        now = numpy.isin(edited["instance"], instances) if is_there else numpy.zeros(len(met), bool)
        behind = met & ~now
        hit = numpy.isfinite(edited_m)
        known = edited["support"] >= KNOWN
        found = behind & hit & known
        count = int(behind.sum())
        out[pathlib.Path(path).stem] = {
            "met": int(met.sum()), "met_edited": int(now.sum()), "behind": count,
            "known_returns": int(found.sum()) / count,
            "near_other_scans": float(near_any(ends_of(edited, edited_m)[found], cells).mean()),
            "known_misses": int((behind & ~hit & known).sum()) / count,
            "unknown": int((behind & (edited["support"] < UNKNOWN)).sum()) / count}
    print(json.dumps(out, indent=1))


if __name__ == "__main__":
    main()
