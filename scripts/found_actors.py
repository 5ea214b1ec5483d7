#!/usr/bin/env python3
"""Compares actors that were found without boxes with those of labelled boxes, which are taken for the truth. Prints
JSON: for each labelled actor that moved, the number of scans in which it has a trajectory, in how many of them a found
actor is within NEAR_M of it, by how many found actors, of what classes, and their median distance."""
import argparse
import json
import pathlib

import numpy

NEAR_M = 1.5
LEAST_WAY_M = 0.5  # of an actor that moved


def trajectories_of(folder):
    """The trajectories of a folder of actors, by name: arrays of time (s), x and y (m, world frame)."""
    scene = json.loads((folder / "scene.json").read_text())
    out = {}
    for mover in scene["movers"]:
        rows = numpy.loadtxt(folder / mover["trajectory"], ndmin=2)[:, :3]
        rows = rows[(rows[:, 0] >= mover["from_s"]) & (rows[:, 0] <= mover["to_s"])]
        out.setdefault(scene["models"][mover["instance"]]["name"], []).append(rows)
    return {name: numpy.unique(numpy.vstack(parts), axis=0) for name, parts in out.items()}


def found_at(rows, found):
    """For each row of a labelled trajectory, the nearest found actor and its horizontal distance, m (or infinity)."""
    names, distances = [], []
    for name, other in found.items():
        at = numpy.column_stack([numpy.interp(rows[:, 0], other[:, 0], other[:, k]) for k in (1, 2)])
        is_there = (rows[:, 0] >= other[0, 0]) & (rows[:, 0] <= other[-1, 0])
        names.append(name)
        distances.append(numpy.where(is_there, numpy.hypot(*(at - rows[:, 1:]).T), numpy.inf))
    distances = numpy.array(distances)
    return [names[k] for k in distances.argmin(0)], distances.min(0)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("labelled", type=pathlib.Path, help="the folder of the actors of labelled boxes")
    parser.add_argument("found", type=pathlib.Path, help="the folder of the actors found without boxes")
    arguments = parser.parse_args()
    found = trajectories_of(arguments.found)
    out, matched = {}, set()
    for name, rows in trajectories_of(arguments.labelled).items():
        if numpy.hypot(*(rows[-1, 1:] - rows[0, 1:])) < LEAST_WAY_M:
            continue
        rows = rows[1:-1]  # without the ends, which are extrapolated
        nearest, distance = found_at(rows, found)
        is_near = distance < NEAR_M
        actors = {actor for actor, near in zip(nearest, is_near) if near}
        matched |= actors
        out[name] = {"scans": len(rows), "found": int(is_near.sum()), "actors": len(actors),
                     "classes": ", ".join(sorted({actor.rpartition("-")[0] for actor in actors})),
                     "distance_m": float(numpy.median(distance[is_near])) if is_near.any() else None}
    print(json.dumps({"labelled": out, "others": sorted(set(found) - matched)}, indent=1))


if __name__ == "__main__":
    main()
